// A half-space's surface: a square around the camera's target, up to the haze.
layout(location = 0) in vec2 a_corner;
uniform mat4 u_view_projection;
uniform mat4 u_pose;    // of the square, relative to the camera's target
uniform vec2 u_phase;   // of the middle in the pattern [m]
uniform float u_reach;  // [m]
out vec3 v_position;
out vec2 v_plane;

void main() {
  vec2 p = u_reach * a_corner;
  v_plane = u_phase + p;
  v_position = (u_pose * vec4(p, 0.0, 1.0)).xyz;
  gl_Position = u_view_projection * vec4(v_position, 1.0);
}
