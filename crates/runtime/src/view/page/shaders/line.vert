// A segment as a quad of constant width on the screen.
layout(location = 0) in vec4 a_from; // point in the node, time
layout(location = 1) in vec4 a_to;
layout(location = 2) in vec4 a_from_colour;
layout(location = 3) in vec4 a_to_colour;

uniform mat4 u_world_from_node;
uniform mat4 u_clip_from_world;
uniform vec2 u_screen;
uniform float u_width; // pixels

out vec4 v_colour;
out float v_time;
out float v_across; // pixels from the middle

void main() {
  mat4 clip_from_node = u_clip_from_world * u_world_from_node;
  vec4 a = clip_from_node * vec4(a_from.xyz, 1.0);
  vec4 b = clip_from_node * vec4(a_to.xyz, 1.0);
  // What is behind the eye is cut off before it is projected.
  float near_a = a.z + a.w;
  float near_b = b.z + b.w;
  vec4 from = near_a < 0.0 ? mix(a, b, near_a / (near_a - near_b)) : a;
  vec4 to = near_b < 0.0 ? mix(b, a, near_b / (near_b - near_a)) : b;

  float end = float(gl_VertexID & 1);
  float side = float(gl_VertexID >> 1) * 2.0 - 1.0;
  vec2 along = (to.xy / to.w - from.xy / from.w) * u_screen;
  along = length(along) > 1e-4 ? normalize(along) : vec2(1.0, 0.0);
  float reach = u_width * 0.5 + 1.0;
  vec2 offset = vec2(-along.y, along.x) * side * reach;
  vec4 at = end < 0.5 ? from : to;
  gl_Position = near_a < 0.0 && near_b < 0.0
    ? vec4(0.0, 0.0, 2.0, 1.0)
    : at + vec4(offset * 2.0 / u_screen * at.w, -0.0004 * at.w, 0.0);
  v_colour = end < 0.5 ? a_from_colour : a_to_colour;
  v_time = end < 0.5 ? a_from.w : a_to.w;
  v_across = side * reach;
}
