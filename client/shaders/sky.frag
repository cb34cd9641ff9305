in vec2 v_uv;
uniform samplerCube u_sky;
uniform mat4 u_inverse_view_projection;
out vec4 o_colour;

void main() {
  vec4 far = u_inverse_view_projection * vec4(2.0 * v_uv - 1.0, 1.0, 1.0);
  vec4 near = u_inverse_view_projection * vec4(2.0 * v_uv - 1.0, -1.0, 1.0);
  vec3 c = textureLod(u_sky, far.xyz / far.w - near.xyz / near.w, 0.0).rgb;
  o_colour = scene_output(c * c, 1.0);
}
