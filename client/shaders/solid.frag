in vec3 v_position;
in vec3 v_normal;
in vec3 v_shadow;
flat in float v_glow;
in vec3 v_albedo;
in vec4 v_material;
out vec4 o_colour;

void main() {
  vec3 n = normalize(v_normal);
  Surface s = Surface(v_albedo, max(v_material.x, 0.06), v_material.y);
  // Nearness of the turf darkens what hangs over it.
  float occlusion = v_material.w * mix(0.65, 1.0, smoothstep(-0.02, 0.07, v_position.z));
  vec3 c = shade(s, v_position, n, v_shadow, occlusion);
  c += v_albedo * v_material.z * 4.0;
  float rim = 1.0 - max(dot(n, normalize(u_eye - v_position)), 0.0);
  c += v_glow * (0.12 + 0.9 * rim * rim) * (0.35 + v_albedo);
  o_colour = scene_output(c, 1.0);
}
