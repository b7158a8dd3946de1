layout(location = 0) in vec3 a_position; // 0..1 in the box of the surface
layout(location = 1) in vec2 a_normal;   // octahedral
layout(location = 2) in vec4 a_row_x;    // world_from_part, by rows
layout(location = 3) in vec4 a_row_y;
layout(location = 4) in vec4 a_row_z;
layout(location = 5) in vec4 a_colour;   // linear light, opacity
layout(location = 6) in vec3 a_finish;   // roughness, metallic, highlight

uniform vec3 u_low, u_size;
uniform mat4 u_clip_from_world;

out vec3 v_position;
out vec3 v_normal;
flat out vec4 v_colour;
flat out vec3 v_finish;

vec3 unfolded(vec2 e) {
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  float t = max(-n.z, 0.0);
  n.xy += vec2(n.x >= 0.0 ? -t : t, n.y >= 0.0 ? -t : t);
  return normalize(n);
}

void main() {
  vec4 local = vec4(u_low + a_position * u_size, 1.0);
  vec3 n = unfolded(a_normal);
  v_position = vec3(dot(a_row_x, local), dot(a_row_y, local), dot(a_row_z, local));
  v_normal = vec3(dot(a_row_x.xyz, n), dot(a_row_y.xyz, n), dot(a_row_z.xyz, n));
  v_colour = a_colour;
  v_finish = a_finish;
  gl_Position = u_clip_from_world * vec4(v_position, 1.0);
}
