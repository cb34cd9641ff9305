// Key light with shadow, a cool fill from behind, hemispheric ambient and the sky as a mirror image.
uniform vec3 u_eye;
uniform vec3 u_key_direction;  // towards the light
uniform vec3 u_key_colour;
uniform highp sampler2DShadow u_shadow_map;
uniform samplerCube u_sky;

const float kPi = 3.14159265;
const vec3 kSkyAmbient = vec3(0.34, 0.42, 0.56);
const vec3 kGroundAmbient = vec3(0.07, 0.10, 0.13);
const vec3 kFillColour = vec3(0.30, 0.42, 0.75);

struct Surface {
  vec3 albedo;
  float roughness;
  float metal;
};

float shadow_bias(float cosine) { return 0.0006 + 0.0016 * (1.0 - cosine); }

// Beyond the map's edge nothing casts: its border compares as far away.
float key_visibility(vec3 shadow_position, float cosine) {
  vec3 p = shadow_position;
  p.z -= shadow_bias(cosine);
#ifdef LOW_QUALITY
  return texture(u_shadow_map, p);
#else
  float texel = 1.0 / float(textureSize(u_shadow_map, 0).x);
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      sum += texture(u_shadow_map, vec3(p.xy + 1.3 * texel * vec2(x, y), p.z));
  return sum / 9.0;
#endif
}

// GGX with the height-correlated visibility term approximated (Lagarde, Frostbite course notes).
vec3 specular_lobe(Surface s, vec3 n, vec3 v, vec3 l, vec3 f0) {
  vec3 h = normalize(v + l);
  float nl = max(dot(n, l), 0.0), nh = max(dot(n, h), 0.0), vh = max(dot(v, h), 0.0);
  float nv = max(dot(n, v), 0.02);
  float a = s.roughness * s.roughness, a2 = a * a;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float visibility = 0.5 / max(mix(2.0 * nl * nv, nl + nv, a), 0.001);
  float away = 1.0 - vh, away2 = away * away;
  vec3 fresnel = f0 + (1.0 - f0) * away2 * away2 * away;
  return fresnel * (a2 / (kPi * d * d)) * visibility * nl;
}

// The sky alone would leave metal black: two soft panels of light hang over the table.
vec3 mirror_image(vec3 r, float roughness) {
  float soft = 0.05 + 0.6 * roughness;
  float panel = smoothstep(0.35 - soft, 0.35 + soft, r.z) * (1.0 - smoothstep(0.22, 0.22 + soft, abs(r.x + 0.28)));
  panel *= 1.0 - 0.85 * roughness;
  vec3 hall = mix(vec3(0.030, 0.042, 0.060), vec3(0.12, 0.15, 0.20), smoothstep(-0.5, 0.7, r.z));
  vec3 image = hall + panel * vec3(1.75, 1.85, 2.0);
#ifndef LOW_QUALITY
  vec3 sky = textureLod(u_sky, r, roughness * 6.0).rgb;
  image += sky * sky * 1.6;
#endif
  return image;
}

float fifth(float x) { return x * x * x * x * x; }

// What a surface sends to the eye: of the key light, if no shadow lies on it, and of all else.
struct Lit {
  vec3 key;
  vec3 rest;
};

Lit light_surface(Surface s, vec3 position, vec3 n, float occlusion) {
#ifdef LOW_QUALITY
  s.roughness = max(s.roughness, 0.45);  // found at corners, a narrow highlight would fill whole faces
#endif
  vec3 v = normalize(u_eye - position);
  vec3 f0 = mix(vec3(0.04), s.albedo, s.metal);
  vec3 diffuse = s.albedo * (1.0 - s.metal);
  float cosine = max(dot(n, u_key_direction), 0.0);
  vec3 fill = normalize(vec3(-u_key_direction.xy, 0.35));
  float rim = fifth(1.0 - max(dot(n, v), 0.0));
  vec3 reflected = f0 + (max(vec3(1.0 - s.roughness), f0) - f0) * rim;

  Lit lit;
  lit.key = u_key_colour * (diffuse / kPi * cosine + specular_lobe(s, n, v, u_key_direction, f0));
  lit.rest = kFillColour * diffuse * max(dot(n, fill), 0.0) * 0.5;
  lit.rest += diffuse * mix(kGroundAmbient, kSkyAmbient, 0.5 + 0.5 * n.z) * occlusion;
  lit.rest += reflected * mirror_image(reflect(-v, n), s.roughness) * occlusion;
  return lit;
}

vec3 shade(Surface s, vec3 position, vec3 n, vec3 shadow_position, float occlusion) {
  Lit lit = light_surface(s, position, n, occlusion);
  return lit.rest + lit.key * key_visibility(shadow_position, max(dot(n, u_key_direction), 0.0));
}
