in vec2 v_uv;
uniform sampler2D u_image;
out vec4 o_colour;

void main() {
  vec2 t = 1.0 / vec2(textureSize(u_image, 0));
  vec3 sum = decode_light(texture(u_image, v_uv).rgb) * 0.25;
  for (int i = 0; i < 4; ++i) {
    vec2 d = vec2(i & 1, i >> 1) * 2.0 - 1.0;
    sum += decode_light(texture(u_image, v_uv + d * t).rgb) * 0.125;
    sum += decode_light(texture(u_image, v_uv + d.x * t * (i < 2 ? vec2(2, 0) : vec2(0, 2))).rgb) * 0.0625;
  }
  o_colour = vec4(encode_light(sum), 1.0);
}
