uniform vec3 u_centre;
uniform float u_reach;
uniform mat4 u_clip_from_world;

out vec3 v_position;

// One triangle round a circle of radius u_reach: a seam between two would show.
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  v_position = u_centre + vec3(corner * u_reach, 0.0);
  gl_Position = u_clip_from_world * vec4(v_position, 1.0);
}
