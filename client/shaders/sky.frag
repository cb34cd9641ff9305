in vec3 v_ray;
uniform samplerCube u_sky;
out vec4 o_colour;

void main() {
  vec3 c = textureLod(u_sky, v_ray, 0.0).rgb;
  o_colour = scene_output(c * c, 1.0);
}
