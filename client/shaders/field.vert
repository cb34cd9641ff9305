layout(location = 0) in vec3 a_position;
uniform mat4 u_view_projection;
uniform mat4 u_shadow_matrix;
out vec3 v_position;
out vec3 v_shadow;

void main() {
  v_position = a_position;
  v_shadow = (u_shadow_matrix * vec4(a_position, 1.0)).xyz;
  gl_Position = u_view_projection * vec4(a_position, 1.0);
}
