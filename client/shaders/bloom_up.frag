in vec2 v_uv;
uniform sampler2D u_image;   // the smaller level
uniform sampler2D u_detail;  // this level, before
out vec4 o_colour;

void main() {
  vec2 t = 1.0 / vec2(textureSize(u_image, 0));
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i)
    sum += decode_light(texture(u_image, v_uv + t * (vec2(i & 1, i >> 1) - 0.5)).rgb) * 0.25;
  o_colour = vec4(encode_light(sum * 0.8 + decode_light(texture(u_detail, v_uv).rgb)), 1.0);
}
