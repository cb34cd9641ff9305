// Glyphs from a distance field, pictures, and panels with rounded corners from their distance.
in vec2 v_uv;
in vec4 v_colour;
flat in vec4 v_shape;
uniform sampler2D u_glyphs;
uniform sampler2D u_pictures;
out vec4 o_colour;

void main() {
  if (v_shape.x < -0.5) {
    o_colour = v_colour * texture(u_pictures, v_uv);
  } else if (v_shape.x <= 0.0) {
    float distance = texture(u_glyphs, v_uv).r - 0.5;
    float blur = v_shape.y;
    float body = smoothstep(-blur, blur, distance);
    float halo = v_shape.z * smoothstep(-0.5, 0.1, distance);
    float alpha = max(body, halo);
    o_colour = vec4(v_colour.rgb * mix(0.0, 1.0, body / max(alpha, 0.001)), v_colour.a * alpha);
  } else {
    vec2 d = abs(v_uv) - v_shape.yz + v_shape.x;
    float distance = length(max(d, 0.0)) + min(max(d.x, d.y), 0.0) - v_shape.x;
    float alpha = 1.0 - smoothstep(-0.7, 0.7, distance);
    if (v_shape.w > 0.0) alpha *= smoothstep(-v_shape.w - 0.7, -v_shape.w + 0.7, distance);
    o_colour = vec4(v_colour.rgb, v_colour.a * alpha);
  }
}
