// The light of the scene: a key light with a shadow map, a sky above, a bounce from the floor.

uniform vec3 u_key;               // towards the key light
uniform vec3 u_sky, u_bounce;     // light from above and from below
uniform float u_key_strength;
uniform mat4 u_shadow_from_world; // to 0..1 in all three
uniform float u_shadow_texel;     // size of a texel in the world, metres
uniform highp sampler2DShadow u_shadow;

// The share of the key light that arrives at a point: 1 in the open. Taps lie on a sunflower, which has no grain; each
// is compared with the plane of the surface, so that a wide penumbra does not darken slopes.
float key_arriving(vec3 position, vec3 normal) {
  const int TAPS = 32;
  const float WIDTH = 7.0; // texels
  vec3 at = (u_shadow_from_world * vec4(position + normal * u_shadow_texel * 1.5, 1.0)).xyz;
  // The map holds all that casts shadows; what lies beyond its far end can still receive them.
  if (any(greaterThan(abs(at.xy - 0.5), vec2(0.5)))) return 1.0;
  mat3 rows = transpose(mat3(u_shadow_from_world));
  vec3 plane = vec3(
    dot(normal, rows[0]) / dot(rows[0], rows[0]),
    dot(normal, rows[1]) / dot(rows[1], rows[1]),
    dot(normal, rows[2]) / dot(rows[2], rows[2])
  );
  vec2 slope = -plane.xy / min(plane.z, -1e-3);
  float texel = 1.0 / float(textureSize(u_shadow, 0).x);
  float sum = 0.0;
  for (int i = 0; i < TAPS; i++) {
    float radius = sqrt((float(i) + 0.5) / float(TAPS)) * WIDTH * texel;
    float angle = float(i) * 2.399963;
    vec2 tap = vec2(cos(angle), sin(angle)) * radius;
    float rise = clamp(dot(slope, tap), -8.0 * radius, 8.0 * radius);
    sum += texture(u_shadow, vec3(at.xy + tap, min(at.z + rise - 2e-4, 1.0)));
  }
  return sum / float(TAPS);
}

// Compresses what is brighter than paper, keeping hues, and encodes for the screen.
vec3 developed(vec3 light) {
  const float start = 0.74;
  const float room = 1.0 - start;
  float peak = max(light.r, max(light.g, light.b));
  if (peak > start) {
    float target = 1.0 - room * room / (peak - start + room);
    light *= target / peak;
    light = mix(light, vec3(target), 1.0 - 1.0 / (0.12 * (peak - target) + 1.0));
  }
  light = max(light, 0.0);
  return mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));
}
