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

float key_visibility(vec3 shadow_position, float cosine) {
  vec3 p = shadow_position;
  if (any(greaterThan(abs(p - 0.5), vec3(0.5)))) return 1.0;
  p.z -= 0.0006 + 0.0016 * (1.0 - cosine);
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
  vec3 fresnel = f0 + (1.0 - f0) * pow(1.0 - vh, 5.0);
  return fresnel * (a2 / (kPi * d * d)) * visibility * nl;
}

// The sky alone would leave metal black: two soft panels of light hang over the table.
vec3 mirror_image(vec3 r, float roughness) {
  vec3 sky = textureLod(u_sky, r, roughness * 6.0).rgb;
  sky *= sky * 1.6;
  float soft = 0.05 + 0.6 * roughness;
  float panel = smoothstep(0.35 - soft, 0.35 + soft, r.z) * (1.0 - smoothstep(0.22, 0.22 + soft, abs(r.x + 0.28)));
  panel *= 1.0 - 0.85 * roughness;
  vec3 hall = mix(vec3(0.030, 0.042, 0.060), vec3(0.12, 0.15, 0.20), smoothstep(-0.5, 0.7, r.z));
  return sky + hall + panel * vec3(1.75, 1.85, 2.0);
}

vec3 shade(Surface s, vec3 position, vec3 n, vec3 shadow_position, float occlusion) {
  vec3 v = normalize(u_eye - position);
  vec3 f0 = mix(vec3(0.04), s.albedo, s.metal);
  vec3 diffuse = s.albedo * (1.0 - s.metal);
  float cosine = max(dot(n, u_key_direction), 0.0);
  float lit = cosine > 0.0 ? key_visibility(shadow_position, cosine) : 0.0;

  vec3 light = u_key_colour * lit * (diffuse / kPi * cosine + specular_lobe(s, n, v, u_key_direction, f0));
  vec3 fill = normalize(vec3(-u_key_direction.xy, 0.35));
  light += kFillColour * diffuse * max(dot(n, fill), 0.0) * 0.5;
  light += diffuse * mix(kGroundAmbient, kSkyAmbient, 0.5 + 0.5 * n.z) * occlusion;

  float rim = pow(1.0 - max(dot(n, v), 0.0), 5.0);
  vec3 reflected = f0 + (max(vec3(1.0 - s.roughness), f0) - f0) * rim;
#ifdef LOW_QUALITY
  // One fetch of the sky a pixel is dear in software: only metal and glass mirror it.
  if (s.metal < 0.5 && s.roughness > 0.25) return light + reflected * vec3(0.12, 0.15, 0.20) * occlusion;
#endif
  return light + reflected * mirror_image(reflect(-v, n), s.roughness) * occlusion;
}
