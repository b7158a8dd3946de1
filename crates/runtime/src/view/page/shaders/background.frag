// A seamless backdrop: the colour depends on how high the eye looks.
in vec2 v_at;

uniform vec3 u_right, u_up, u_ahead; // scaled so that their sum reaches the corner of the picture
uniform vec3 u_zenith, u_horizon, u_floor;

out vec4 colour;

void main() {
  vec2 at = v_at * 2.0 - 1.0;
  float height = normalize(u_ahead + u_right * at.x + u_up * at.y).z;
  vec3 shade = mix(u_horizon, u_zenith, smoothstep(0.0, 0.75, height));
  shade = mix(shade, u_floor, smoothstep(0.02, -0.45, height));
  // Less than one step of the screen's scale, so that the gradient shows no bands.
  float grain = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453);
  colour = vec4(shade + (grain - 0.5) / 255.0, 1.0);
}
