// Ambient occlusion on the screen: around each pixel, how much of the upper half space do near surfaces take?
// Normals come from depth, so that no other picture is needed.
in vec2 v_at;

uniform highp sampler2D u_depth;
uniform mat4 u_view_from_clip;
uniform vec2 u_scale;     // of clip x and y, for one unit across at one unit ahead
uniform float u_radius;   // how far things darken each other, metres

out vec4 colour;

vec3 place(vec2 at) {
  vec4 p = u_view_from_clip * (vec4(at, texture(u_depth, at).r, 1.0) * 2.0 - 1.0);
  return p.xyz / p.w;
}

void main() {
  if (texture(u_depth, v_at).r >= 1.0) {
    colour = vec4(1.0);
    return;
  }
  vec2 pixel = 1.0 / vec2(textureSize(u_depth, 0));
  vec3 here = place(v_at);
  // Of both neighbours in a row the nearer in depth lies on the same surface.
  vec3 right = place(v_at + vec2(pixel.x, 0.0)) - here;
  vec3 left = here - place(v_at - vec2(pixel.x, 0.0));
  vec3 above = place(v_at + vec2(0.0, pixel.y)) - here;
  vec3 below = here - place(v_at - vec2(0.0, pixel.y));
  vec3 dx = abs(right.z) < abs(left.z) ? right : left;
  vec3 dy = abs(above.z) < abs(below.z) ? above : below;
  vec3 normal = normalize(cross(dx, dy));

  vec2 reach = 0.5 * u_radius * u_scale / -here.z;
  float turn = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) * 6.2831853;
  float taken = 0.0;
  const int TAPS = 20;
  for (int i = 0; i < TAPS; i++) {
    float r = (float(i) + 0.5) / float(TAPS);
    float angle = turn + float(i) * 2.399963;
    vec3 away = place(v_at + vec2(cos(angle), sin(angle)) * r * reach) - here;
    float distance = length(away) + 1e-5;
    float height = dot(away, normal) / distance;
    float near = max(1.0 - distance * distance / (u_radius * u_radius), 0.0);
    taken += max(height - 0.12, 0.0) * near * (0.4 + r);
  }
  float open = clamp(1.0 - 3.4 * taken / float(TAPS), 0.0, 1.0);
  colour = vec4(vec3(open), 1.0);
}
