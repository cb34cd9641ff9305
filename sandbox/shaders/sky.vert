// One triangle over the whole target at the far plane, each corner with the ray that it looks along.
uniform mat3 u_ray;  // columns: the picture's half width, half height and middle, in the world
out vec3 v_ray;

void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  v_ray = u_ray * vec3(p, 1.0);
  gl_Position = vec4(p, 1.0, 1.0);
}
