// Instanced solids: table, rods, handles, men.
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 a_albedo;    // square root of linear rgb; a: share of the tint
layout(location = 3) in vec4 a_material;  // roughness, metal, emission / 4, occlusion
layout(location = 4) in vec4 i_row0;      // rows of the pose, world from mesh (rigid or mirrored)
layout(location = 5) in vec4 i_row1;
layout(location = 6) in vec4 i_row2;
layout(location = 7) in vec4 i_tint;      // linear rgb; a: glow, of a rod in a hand above 1
uniform mat4 u_view_projection;
uniform mat4 u_shadow_matrix;
out vec3 v_shadow;
out vec2 v_stripe;  // along the rod [m], and 1 on a rod in a hand
#ifdef LOW_QUALITY
out vec3 v_key;
out vec3 v_rest;
#else
out vec3 v_position;
out vec3 v_normal;
out vec3 v_albedo;
out vec4 v_material;
flat out float v_glow;
#endif

void main() {
  vec4 p = vec4(a_position, 1.0);
  vec3 position = vec3(dot(i_row0, p), dot(i_row1, p), dot(i_row2, p));
  vec3 normal = vec3(dot(i_row0.xyz, a_normal), dot(i_row1.xyz, a_normal), dot(i_row2.xyz, a_normal));
  bool in_hand = i_tint.a > 1.0;
  float glow = in_hand ? i_tint.a - 1.0 : i_tint.a;
  v_stripe = vec2(a_position.y, in_hand ? 1.0 : 0.0);
  vec3 albedo = a_albedo.rgb * a_albedo.rgb;
  albedo = mix(albedo, albedo * i_tint.rgb, a_albedo.a);
  v_shadow = (u_shadow_matrix * vec4(position, 1.0)).xyz;
  gl_Position = u_view_projection * vec4(position, 1.0);
#ifdef LOW_QUALITY
  // Software OpenGL pays for every operation on every pixel: the light is found at the corners, only
  // its shadow at each pixel.
  Lit lit = light_solid(position, normalize(normal), albedo, a_material, glow);
  v_shadow.z -= shadow_bias(max(dot(normalize(normal), u_key_direction), 0.0));
  v_key = lit.key;
  v_rest = lit.rest;
#else
  v_position = position;
  v_normal = normal;
  v_albedo = albedo;
  v_material = a_material;
  v_glow = glow;
#endif
}
