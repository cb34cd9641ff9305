in vec3 v_shadow;
in vec2 v_stripe;
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
uniform vec4 u_see_through;  // the ball on the target: place, radius [px]; its depth
out vec4 o_colour;

// What stands before the ball is left out in two pixels of three, and at the rim of its disc in fewer.
void let_the_ball_be_seen() {
  float away = distance(gl_FragCoord.xy, u_see_through.xy);
  if (away > u_see_through.z || gl_FragCoord.z > u_see_through.w) return;
  float kept = mod(floor(gl_FragCoord.x) + floor(gl_FragCoord.y), 3.0);
  if (kept > 0.5) discard;
}

// Light and dark by turns along a rod in a hand: plain in any colours, from any side.
vec3 marked(vec3 colour) {
  if (v_stripe.y < 0.5) return colour;
  return fract(v_stripe.x * 16.0) < 0.5 ? colour * 0.08 : colour * 0.35 + vec3(0.85, 0.74, 0.22);
}

void main() {
  let_the_ball_be_seen();
#ifdef LOW_QUALITY
  o_colour = scene_output(marked(v_rest + v_key * texture(u_shadow_map, v_shadow)), 1.0);
#else
  vec3 n = normalize(v_normal);
  Lit lit = light_solid(v_position, n, v_albedo, v_material, v_glow);
  float visible = key_visibility(v_shadow, max(dot(n, u_key_direction), 0.0));
  o_colour = scene_output(marked(lit.rest + lit.key * visible), 1.0);
#endif
}
