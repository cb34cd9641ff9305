// Nebula, milky band and a planet's limb, drawn once into each face of a cube map. Coded as a square
// root, so that 8 bits suffice for the dark.
in vec2 v_uv;
uniform mat3 u_face;  // columns: right, up, outwards
out vec4 o_colour;

float hash(vec3 p) {
  p = fract(p * vec3(0.1031, 0.1030, 0.0973));
  p += dot(p, p.yxz + 33.33);
  return fract((p.x + p.y) * p.z);
}

float noise(vec3 p) {
  vec3 i = floor(p), f = fract(p);
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(mix(hash(i), hash(i + vec3(1, 0, 0)), f.x),
                 mix(hash(i + vec3(0, 1, 0)), hash(i + vec3(1, 1, 0)), f.x), f.y),
             mix(mix(hash(i + vec3(0, 0, 1)), hash(i + vec3(1, 0, 1)), f.x),
                 mix(hash(i + vec3(0, 1, 1)), hash(i + vec3(1, 1, 1)), f.x), f.y), f.z);
}

float fbm(vec3 p) {
  float sum = 0.0, weight = 0.5;
  for (int i = 0; i < 5; ++i) {
    sum += weight * noise(p);
    p = p.yzx * 2.03 + 7.1;
    weight *= 0.5;
  }
  return sum;
}

vec3 nebula(vec3 d) {
  vec3 warp = vec3(fbm(d * 2.1 + 3.0), fbm(d * 2.1 + 11.0), fbm(d * 2.1 + 23.0));
  float cloud = fbm(d * 2.6 + 1.9 * warp);
  float veil = fbm(d * 5.0 + 2.5 * warp.zxy + 40.0);
  float band = exp(-pow(dot(d, normalize(vec3(0.25, -0.45, 0.86))) * 2.2 + 0.35 * (warp.x - 0.5), 2.0));
  vec3 c = vec3(0.0060, 0.0070, 0.0180);
  c += vec3(0.130, 0.130, 0.420) * smoothstep(0.42, 0.85, cloud) * (0.35 + band);
  c += vec3(0.900, 0.220, 0.800) * pow(smoothstep(0.40, 0.90, veil * 0.6 + cloud * 0.5), 2.0) * band;
  c += vec3(0.070, 0.280, 0.340) * pow(smoothstep(0.45, 0.85, warp.y), 2.0) * (0.4 + 0.6 * band);
  return c * (1.0 - 0.6 * smoothstep(0.45, 0.75, veil) * band);
}

// The table hangs over a planet at night: its limb rises behind the far wall from either side, and a
// few lights of cities keep the dark alive.
vec3 planet(vec3 d, vec3 sky) {
  const float radius = 0.740;  // [rad]; kLimb in sky.cpp
  float angle = acos(clamp(-d.z, -1.0, 1.0));
  float inside = radius - angle;
  vec2 around = normalize(d.xy + vec2(1e-5, 0.0));
  float lit = 0.20 + 0.80 * smoothstep(-0.9, 0.9, -around.x);
  vec3 air = vec3(0.10, 0.32, 0.66) * lit;
  vec3 glow = sky + air * 0.85 * exp(min(inside, 0.0) * 30.0);
  if (inside < -0.006) return glow;
  float r = angle / radius;
  vec3 n = vec3(around * r, sqrt(max(1.0 - r * r, 0.0)));
  float clouds = fbm(n * 3.2 + 1.4 * fbm(n * 5.0 + 9.0));
  float land = smoothstep(0.50, 0.56, fbm(n * 2.3 + 31.0));
  float day = smoothstep(-0.2, 1.1, -around.x * r);
  vec3 ground = mix(vec3(0.0040, 0.0160, 0.0360), vec3(0.0130, 0.0160, 0.0160), land);
  ground += vec3(0.090, 0.115, 0.160) * smoothstep(0.48, 0.80, clouds);
  float city = land * smoothstep(0.74, 0.90, noise(n * 26.0)) * smoothstep(0.55, 0.9, noise(n * 90.0));
  vec3 c = ground * (0.45 + 2.4 * day) + vec3(0.60, 0.34, 0.13) * city * (1.0 - smoothstep(0.45, 0.7, clouds));
  c += air * 0.55 * exp(-max(inside, 0.0) * 11.0);
  return mix(glow, c, smoothstep(-0.004, 0.004, inside));  // two texels wide: no stairs
}

void main() {
  vec2 p = 2.0 * v_uv - 1.0;
  vec3 d = normalize(u_face * vec3(p, 1.0));
  vec3 c = planet(d, nebula(d));
  o_colour = vec4(sqrt(c) + dither(gl_FragCoord.xy) / 255.0, 1.0);
}
