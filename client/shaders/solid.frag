in vec3 v_shadow;
#ifdef LOW_QUALITY
in vec3 v_key;
in vec3 v_rest;
#else
in vec3 v_position;
in vec3 v_normal;
in vec3 v_albedo;
in vec4 v_material;
flat in float v_glow;
#endif
out vec4 o_colour;

void main() {
#ifdef LOW_QUALITY
  o_colour = scene_output(v_rest + v_key * texture(u_shadow_map, v_shadow), 1.0);
#else
  vec3 n = normalize(v_normal);
  Lit lit = light_solid(v_position, n, v_albedo, v_material, v_glow);
  float visible = key_visibility(v_shadow, max(dot(n, u_key_direction), 0.0));
  o_colour = scene_output(lit.rest + lit.key * visible, 1.0);
#endif
}
