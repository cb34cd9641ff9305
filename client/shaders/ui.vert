layout(location = 0) in vec2 a_position;  // [px] from the top left
layout(location = 1) in vec2 a_uv;        // glyph: atlas; panel: offset from its centre [px]
layout(location = 2) in vec4 a_colour;
layout(location = 3) in vec4 a_shape;     // glyph: (0, softness, glow, 0); picture: (-1, 0, 0, 0); panel: (corner, half size, outline)
uniform vec2 u_screen;
out vec2 v_uv;
out vec4 v_colour;
flat out vec4 v_shape;

void main() {
  v_uv = a_uv;
  v_colour = a_colour;
  v_shape = a_shape;
  gl_Position = vec4(a_position / u_screen * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.0, 1.0);
}
