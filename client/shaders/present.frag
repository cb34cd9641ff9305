// Light to screen: a little bloom, tone curve, a soft vignette.
in vec2 v_uv;
uniform sampler2D u_image;
uniform sampler2D u_bloom;
out vec4 o_colour;

void main() {
  vec3 c = decode_light(texture(u_image, v_uv).rgb);
  c += 0.55 * decode_light(texture(u_bloom, v_uv).rgb);
  vec2 p = v_uv - 0.5;
  c *= 1.0 - 0.35 * smoothstep(0.15, 0.60, dot(p, p));
  o_colour = vec4(tone_map(c) + dither(gl_FragCoord.xy) / 255.0, 1.0);
}
