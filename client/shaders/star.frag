in vec3 v_colour;
out vec4 o_colour;

void main() {
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  o_colour = scene_output(v_colour * exp(-3.0 * dot(p, p)), 1.0);
}
