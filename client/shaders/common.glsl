// Shared by every shader of the scene: colour coding and the light of the hall.
//
// The scene is drawn in linear light into a 10-bit target (RGB10_A2: core in ES 3.0, no extension),
// coded as sqrt(c / (1 + c)): unbounded light in a bounded channel, fine steps in the dark.
vec3 encode_light(vec3 c) { return sqrt(c / (1.0 + c)); }
vec3 decode_light(vec3 e) {
  vec3 q = min(e * e, vec3(0.998));
  return q / (1.0 - q);
}

// Narkowicz' fit of the ACES curve, then the sRGB curve.
vec3 tone_map(vec3 c) {
  c *= 0.92;
  c = clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
#ifdef LOW_QUALITY
  // The sRGB curve from three roots, which cost far less than a power in software; the coefficients
  // are a fit, off by less than 0.005.
  vec3 s1 = sqrt(c), s2 = sqrt(s1), s3 = sqrt(s2);
  return clamp(0.662002687 * s1 + 0.684122060 * s2 - 0.323583601 * s3 - 0.0225411470 * c, 0.0, 1.0);
#else
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
#endif
}

// Half a step of noise against banding in the dark sky.
float dither(vec2 pixel) {
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
}

#ifdef LOW_QUALITY
// Low quality has no post pass: the scene shaders write what the screen shows.
vec4 scene_output(vec3 c, float alpha) { return vec4(tone_map(c) + dither(gl_FragCoord.xy) / 255.0, alpha); }
#else
vec4 scene_output(vec3 c, float alpha) { return vec4(encode_light(c) + dither(gl_FragCoord.xy) / 1023.0, alpha); }
#endif
