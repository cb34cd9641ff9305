// Light in the open: a sun with a shadow, the sky above, and what the ground sends back.
const vec3 kSun = vec3(4.3, 3.95, 3.35);
const vec3 kSkyLight = vec3(0.31, 0.39, 0.52);
const vec3 kGroundLight = vec3(0.17, 0.16, 0.15);
const vec3 kHorizon = vec3(0.70, 0.77, 0.85);
const vec3 kZenith = vec3(0.17, 0.32, 0.58);

uniform vec3 u_eye;            // all positions are relative to the camera's target [m]
uniform vec3 u_sun_direction;  // towards it
uniform mat4 u_shadow_matrix;  // to the shadow map's coordinates
uniform float u_shadow_texel;  // of the map [m]
uniform float u_haze;          // share of light lost in a metre
uniform highp sampler2DShadow u_shadow_map;

// Narkowicz' fit of the ACES curve, then the sRGB curve.
vec3 tone_map(vec3 c) {
  c *= 0.62;
  c = clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}

vec3 sky_colour(vec3 direction) {
  float up = max(direction.z, 0.0);
  vec3 c = mix(kHorizon, kZenith, 1.0 - pow(1.0 - up, 3.0));
  float near_sun = max(dot(direction, u_sun_direction), 0.0);
  return c + vec3(0.35, 0.28, 0.18) * pow(near_sun, 12.0);
}

// Share of the sun that reaches the position; the map is asked a little off the surface.
float sun_at(vec3 position, vec3 normal) {
  vec3 p = (u_shadow_matrix * vec4(position + 1.6 * u_shadow_texel * normal, 1.0)).xyz;
  if (any(greaterThan(abs(p - 0.5), vec3(0.5)))) return 1.0;
#ifdef LOW_QUALITY
  return texture(u_shadow_map, p);
#else
  float texel = 1.0 / float(textureSize(u_shadow_map, 0).x);
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      sum += texture(u_shadow_map, vec3(p.xy + 1.2 * texel * vec2(x, y), p.z));
  return sum / 9.0;
#endif
}

vec3 lit(vec3 albedo, vec3 position, vec3 normal, float gloss) {
  float cosine = max(dot(normal, u_sun_direction), 0.0);
  float sun = cosine > 0.0 ? sun_at(position, normal) * cosine : 0.0;
  vec3 c = albedo * (0.318 * kSun * sun + mix(kGroundLight, kSkyLight, 0.5 + 0.5 * normal.z));
  // An edge narrower than a pixel would glitter: what turns that fast does not shine.
  gloss *= 1.0 - smoothstep(0.25, 0.7, length(fwidth(normal)));
  vec3 v = normalize(u_eye - position);
  float rim = 1.0 - max(dot(normal, v), 0.0);
  float fresnel = 0.04 + 0.5 * rim * rim * rim * rim * rim;
  c += gloss * fresnel * sky_colour(reflect(-v, normal));
  float shine = max(dot(normal, normalize(v + u_sun_direction)), 0.0);
  return c + gloss * 0.35 * kSun * sun * pow(shine, 60.0);
}

vec3 through_haze(vec3 c, vec3 position) {
  vec3 way = position - u_eye;
  float clear = exp(-u_haze * length(way));
  return mix(sky_colour(normalize(vec3(way.xy, 0.02 * length(way)))), c, clear);
}
