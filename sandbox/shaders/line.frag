in vec4 v_colour;
uniform bool u_round;
out vec4 o_colour;

void main() {
  float off = 2.0 * length(gl_PointCoord - 0.5);
  float alpha = u_round ? 1.0 - smoothstep(0.7, 1.0, off) : 1.0;
  o_colour = vec4(v_colour.rgb, v_colour.a * alpha);
}
