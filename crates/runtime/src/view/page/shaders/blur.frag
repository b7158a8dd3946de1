// Takes the grain out of the occlusion without carrying it over edges in depth.
in vec2 v_at;

uniform highp sampler2D u_depth;
uniform sampler2D u_grainy;
uniform vec2 u_step;  // one pixel across or up
uniform vec2 u_range; // near and far

out vec4 colour;

float ahead(vec2 at) {
  float d = texture(u_depth, at).r * 2.0 - 1.0;
  return 2.0 * u_range.x * u_range.y / (u_range.y + u_range.x - d * (u_range.y - u_range.x));
}

void main() {
  float here = ahead(v_at);
  float sum = 0.0;
  float weights = 0.0;
  for (int i = -4; i <= 4; i++) {
    vec2 at = v_at + float(i) * u_step;
    float weight = exp(-0.09 * float(i * i)) * max(1.0 - abs(ahead(at) - here) / (0.02 * here), 0.0);
    sum += weight * texture(u_grainy, at).r;
    weights += weight;
  }
  colour = vec4(vec3(weights > 0.0 ? sum / weights : 1.0), 1.0);
}
