in vec4 v_colour;
in float v_time;
in float v_across;

uniform float u_width;
uniform float u_time;
uniform float u_opacity;

out vec4 colour;

void main() {
  float edge = 1.0 - smoothstep(u_width * 0.5 - 0.5, u_width * 0.5 + 0.5, abs(v_across));
  float ahead = v_time > u_time ? 0.28 : 1.0;
  colour = vec4(v_colour.rgb, v_colour.a * edge * ahead * u_opacity);
}
