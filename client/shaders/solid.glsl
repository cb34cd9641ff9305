uniform float u_fade;  // of light with height [1/m], in the mirror

// How table, rods and men answer to the light; shared by both qualities.
Lit light_solid(vec3 position, vec3 n, vec3 albedo, vec4 material, float glow) {
  Surface s = Surface(albedo, max(material.x, 0.06), material.y);
  // Nearness of the turf darkens what hangs over it.
  float occlusion = material.w * mix(0.65, 1.0, smoothstep(-0.02, 0.07, position.z));
  Lit lit = light_surface(s, position, n, occlusion);
  float rim = 1.0 - max(dot(n, normalize(u_eye - position)), 0.0);
  lit.rest += albedo * material.z * 4.0;
  lit.rest += glow * (0.12 + 0.9 * rim * rim) * (0.35 + albedo);
  float seen = exp(-u_fade * max(position.z, 0.0));
  return Lit(lit.key * seen, lit.rest * seen);
}
