in vec4 v_colour;
out vec4 o_colour;

void main() {
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  float fade = max(1.0 - dot(p, p), 0.0);
  o_colour = scene_output(v_colour.rgb, 1.0) * (fade * fade * v_colour.a);
}
