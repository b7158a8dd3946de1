in vec3 v_position;
in vec3 v_normal;
flat in vec4 v_colour;
flat in vec3 v_finish;

uniform vec3 u_eye;
uniform vec2 u_screen;
uniform sampler2D u_openness; // how much of the sky is seen from what is at a pixel

out vec4 colour;

const float PI = 3.14159265;

// Share of facets that mirror `h`, times how many of them are seen and lit (GGX, height-correlated Smith).
float facets(float nh, float nv, float nl, float roughness) {
  float a = roughness * roughness;
  float a2 = a * a;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float seen = nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2);
  return a2 / (PI * d * d) * 0.5 / max(seen, 1e-4);
}

// A studio to be mirrored: a bright ceiling panel, a window at the side, and the floor.
vec3 studio(vec3 d, float roughness) {
  float blur = mix(0.06, 0.7, roughness);
  vec3 ambient = mix(u_bounce, u_sky, smoothstep(-0.35 - blur, 0.35 + blur, d.z));
  float panel = smoothstep(0.80 - blur, 0.88 + blur, dot(d, normalize(vec3(0.1, -0.35, 1.0))));
  float window = smoothstep(0.78 - blur, 0.90 + blur, dot(d, normalize(vec3(0.75, 0.75, 0.35))));
  return ambient + vec3(1.0, 0.98, 0.95) * panel * 0.9 + vec3(0.85, 0.92, 1.0) * window * 0.5;
}

void main() {
  vec3 view = normalize(u_eye - v_position);
  vec3 normal = normalize(v_normal) * (gl_FrontFacing ? 1.0 : -1.0);
  float roughness = max(v_finish.x, 0.08);
  float metallic = v_finish.y;
  vec3 base = v_colour.rgb * (1.0 - metallic);
  vec3 mirror = mix(vec3(0.04), v_colour.rgb, metallic);

  float nv = max(dot(normal, view), 1e-3);
  float nl = max(dot(normal, u_key), 0.0);
  vec3 halfway = normalize(view + u_key);
  float nh = max(dot(normal, halfway), 0.0);
  float key = u_key_strength * nl;
  if (key > 0.0) key *= key_arriving(v_position, normal);
  float open = texture(u_openness, gl_FragCoord.xy / u_screen).r;

  vec3 grazing = mirror + (1.0 - mirror) * pow(1.0 - max(dot(view, halfway), 0.0), 5.0);
  vec3 rim = mirror + (max(vec3(1.0 - roughness), mirror) - mirror) * pow(1.0 - nv, 5.0);
  vec3 ambient = mix(u_bounce, u_sky, normal.z * 0.5 + 0.5);

  vec3 light = base * (ambient * open + key / PI);
  light += grazing * facets(nh, nv, max(nl, 1e-3), roughness) * key;
  light += rim * studio(reflect(-view, normal), roughness) * mix(open, 1.0, 0.2);
  light = mix(light, vec3(1.0, 0.62, 0.12), v_finish.z * (0.12 + 0.5 * pow(1.0 - nv, 2.0)));
  colour = vec4(developed(light), v_colour.a);
}
