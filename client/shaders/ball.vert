layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
uniform mat4 u_view_projection;
uniform mat4 u_shadow_matrix;
uniform mat4 u_model;
out vec3 v_position;
out vec3 v_normal;
out vec3 v_shadow;
out vec3 v_local;

void main() {
  vec4 p = u_model * vec4(a_position, 1.0);
  v_position = p.xyz;
  v_normal = mat3(u_model) * a_normal;
  v_local = a_normal;
  v_shadow = (u_shadow_matrix * p).xyz;
  gl_Position = u_view_projection * p;
}
