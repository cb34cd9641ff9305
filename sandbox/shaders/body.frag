in vec3 v_position;
in vec3 v_normal;
flat in vec4 v_colour;
out vec4 o_colour;

void main() {
  vec3 c = lit(v_colour.rgb, v_position, normalize(v_normal), v_colour.a);
  o_colour = vec4(tone_map(through_haze(c, v_position)), 1.0);
}
