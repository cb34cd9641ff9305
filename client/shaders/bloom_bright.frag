// Keeps what is brighter than paper white, halved in size.
in vec2 v_uv;
uniform sampler2D u_image;
out vec4 o_colour;

void main() {
  vec2 texel = 1.0 / vec2(textureSize(u_image, 0));
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    vec3 c = decode_light(texture(u_image, v_uv + texel * (vec2(i & 1, i >> 1) * 2.0 - 1.0)).rgb);
    float peak = max(c.r, max(c.g, c.b));
    sum += min(c * smoothstep(0.8, 2.0, peak), 6.0) * 0.25;
  }
  o_colour = vec4(encode_light(sum), 1.0);
}
