// What hides the bodies, as thin glass.
in vec3 v_position;
in vec3 v_normal;
flat in vec4 v_colour;
uniform vec3 u_eye;
out vec4 o_colour;

void main() {
  float rim = 1.0 - abs(dot(normalize(v_normal), normalize(u_eye - v_position)));
  o_colour = vec4(0.86, 0.92, 0.98, 0.05 + 0.13 * rim * rim);
}
