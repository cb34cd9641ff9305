// Instances of one kind of shape: point = core * stretch + round * normal. So corners of a box, the
// middle line of a capsule are the core, what rounds them is around it.
layout(location = 0) in vec3 a_core;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 i_row0;     // rows of the pose, relative to the camera's target
layout(location = 3) in vec4 i_row1;
layout(location = 4) in vec4 i_row2;
layout(location = 5) in vec4 i_stretch;  // of the core; a: round [m]
layout(location = 6) in vec4 i_colour;   // linear rgb; a: gloss
uniform mat4 u_view_projection;
out vec3 v_position;
out vec3 v_normal;
flat out vec4 v_colour;

void main() {
  vec4 p = vec4(a_core * i_stretch.xyz + a_normal * i_stretch.w, 1.0);
  // Without a round part the core is a surface that is stretched.
  vec3 n = i_stretch.w > 0.0 ? a_normal : a_normal / i_stretch.xyz;
  v_position = vec3(dot(i_row0, p), dot(i_row1, p), dot(i_row2, p));
  v_normal = vec3(dot(i_row0.xyz, n), dot(i_row1.xyz, n), dot(i_row2.xyz, n));
  v_colour = i_colour;
  gl_Position = u_view_projection * vec4(v_position, 1.0);
}
