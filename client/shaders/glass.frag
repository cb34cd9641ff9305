// The side walls above their foot: clear, so that the near wall hides nothing of the field. Their edge
// glows in the colour of the team that stands there.
in vec3 v_position;
in vec3 v_normal;
uniform vec3 u_eye;
uniform float u_top;  // [m]
uniform vec3 u_team_lamp[2];
out vec4 o_colour;

void main() {
  vec3 v = normalize(u_eye - v_position);
  float facing = abs(dot(normalize(v_normal), v));
  float edge = smoothstep(u_top - 0.006, u_top - 0.001, v_position.z);
  // The near wall's edge lies across the field in the picture: it must not hide the ball.
  float lamp = v_position.y * u_eye.y > 0.0 ? 0.28 : 0.65;
  float alpha = 0.04 + 0.16 * pow(1.0 - facing, 3.0) + lamp * edge;
  vec3 light = 3.2 * u_team_lamp[v_position.y < 0.0 ? 0 : 1] + 0.10;
  o_colour = scene_output(mix(vec3(0.32, 0.50, 0.62), light, edge), alpha);
}
