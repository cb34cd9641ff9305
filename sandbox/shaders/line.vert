// Lines and points: marks over the picture.
layout(location = 0) in vec3 a_position;  // relative to the camera's target
layout(location = 1) in vec4 a_colour;    // as the screen shows it
layout(location = 2) in float a_behind;   // opacity behind bodies
uniform mat4 u_view_projection;
uniform bool u_behind;
uniform float u_point_size;  // [px]
out vec4 v_colour;

void main() {
  v_colour = vec4(a_colour.rgb, u_behind ? a_behind * a_colour.a : a_colour.a);
  gl_Position = u_view_projection * vec4(a_position, 1.0);
  gl_PointSize = u_point_size;
}
