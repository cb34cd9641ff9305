// Squares of a metre, and of ten, which blur into one tone before they flicker.
in vec3 v_position;
in vec2 v_plane;
uniform vec3 u_normal;
out vec4 o_colour;

float lines(float pitch, float width) {
  vec2 p = v_plane / pitch, blur = fwidth(p);
  vec2 near = abs(fract(p - 0.5) - 0.5);
  vec2 line = 1.0 - smoothstep(vec2(0.0), blur * 1.5, near - 0.5 * width / pitch);
  line *= clamp(0.35 / max(blur, vec2(1e-5)), 0.0, 1.0);
  return max(line.x, line.y);
}

void main() {
  vec3 albedo = vec3(0.27, 0.28, 0.295);
  albedo = mix(albedo, vec3(0.21, 0.22, 0.235), 0.7 * lines(1.0, 0.02));
  albedo = mix(albedo, vec3(0.13, 0.14, 0.16), 0.8 * lines(10.0, 0.05));
  vec3 c = lit(albedo, v_position, u_normal, 0.25);
  o_colour = vec4(tone_map(through_haze(c, v_position)), 1.0);
}
