// The floor is laid over the backdrop: shadows darken it, lines of a grid mark metres and their quarters.
in vec3 v_position;

uniform vec3 u_centre;
uniform float u_reach;
uniform vec3 u_eye;
uniform vec2 u_screen;
uniform vec4 u_line, u_shade, u_pool; // colour as seen and opacity
uniform sampler2D u_openness;

out vec4 colour;

// How much of a pixel is covered by lines `spacing` apart; fades where lines come closer than pixels.
float grid(vec2 p, float spacing, float width) {
  vec2 cells = p / spacing;
  vec2 pixel = fwidth(cells);
  vec2 away = abs(fract(cells - 0.5) - 0.5) / pixel;
  vec2 lines = 1.0 - smoothstep(width * 0.5 - 0.5, width * 0.5 + 0.5, away);
  lines *= 1.0 - smoothstep(0.2, 0.5, pixel);
  return max(lines.x, lines.y);
}

// Colour `b` laid over `a`, both premultiplied.
vec4 over(vec4 a, vec4 b) {
  return b + a * (1.0 - b.a);
}

void main() {
  float far = length(v_position.xy - u_centre.xy) / u_reach;
  float fade = 1.0 - smoothstep(0.15, 0.9, far);
  float arriving = key_arriving(v_position, vec3(0.0, 0.0, 1.0));
  float open = texture(u_openness, gl_FragCoord.xy / u_screen).r;
  float dark = 1.0 - mix(1.0, arriving, 0.62) * mix(1.0, open, 0.75);
  float lines = max(grid(v_position.xy, 1.0, 1.4), 0.4 * grid(v_position.xy, 0.25, 1.0));

  float pool = u_pool.a * (1.0 - smoothstep(0.0, 0.45, far));
  vec4 paint = vec4(u_pool.rgb, 1.0) * pool;
  paint = over(paint, vec4(u_line.rgb, 1.0) * u_line.a * lines * fade);
  paint = over(paint, vec4(u_shade.rgb, 1.0) * u_shade.a * dark * fade);
  // Seen from below the floor is glass.
  colour = paint * (u_eye.z > v_position.z ? 1.0 : 0.25);
}
