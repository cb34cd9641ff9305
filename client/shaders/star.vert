layout(location = 0) in vec4 a_star;    // direction, brightness
layout(location = 1) in vec3 a_colour;
uniform mat4 u_view_projection;         // without translation
uniform float u_pixel_scale;
uniform float u_time;
out vec3 v_colour;

void main() {
  gl_Position = (u_view_projection * vec4(a_star.xyz, 1.0)).xyww;
  gl_PointSize = (1.4 + 2.2 * a_star.w) * u_pixel_scale;
  float twinkle = 0.85 + 0.15 * sin(u_time * (0.5 + 2.0 * fract(a_star.x * 57.0)) + a_star.y * 90.0);
  v_colour = a_colour * (0.10 + 1.3 * a_star.w * a_star.w) * twinkle;
}
