layout(location = 0) in vec4 a_point;   // position, radius [m]
layout(location = 1) in vec4 a_colour;  // light, opacity
uniform mat4 u_view_projection;
uniform float u_pixels_per_unit;        // height of a metre at unit depth [px]
out vec4 v_colour;

void main() {
  gl_Position = u_view_projection * vec4(a_point.xyz, 1.0);
  gl_PointSize = max(2.0 * a_point.w * u_pixels_per_unit / gl_Position.w, 1.0);
  v_colour = a_colour;
}
