// The classic ball: a truncated icosahedron's panels, found from the direction in the ball's own
// frame, so that its spin can be seen.
in vec3 v_position;
in vec3 v_normal;
in vec3 v_shadow;
in vec3 v_local;
uniform float u_fade;  // of light with height [1/m], in the mirror
out vec4 o_colour;

void main() {
  const float a = 0.5257311, b = 0.8506508;       // icosahedron's vertices (0, a, b) and turns
  const float c = 0.3568221, d = 0.9341724, e = 0.5773503;  // its face centres
  vec3 q = abs(normalize(v_local));               // by symmetry one octant is enough
  float pentagon = max(max(dot(q, vec3(0.0, a, b)), dot(q, vec3(a, b, 0.0))), dot(q, vec3(b, 0.0, a)));
  float h0 = dot(q, vec3(e)), h1 = dot(q, vec3(c, 0.0, d)), h2 = dot(q, vec3(0.0, d, c)),
        h3 = dot(q, vec3(d, c, 0.0));
  float first = max(max(h0, h1), max(h2, h3));
  float second = max(min(h0, max(h1, max(h2, h3))), max(min(h1, max(h2, h3)), min(h2, h3)));
  // Across an octant's border the mirrored neighbour of h1..h3 is the second.
  second = max(second, max(max(dot(q, vec3(c, 0.0, -d)), dot(q, vec3(-c, 0.0, d))),
                           max(max(dot(q, vec3(0.0, d, -c)), dot(q, vec3(0.0, -d, c))),
                               max(dot(q, vec3(d, -c, 0.0)), dot(q, vec3(-d, c, 0.0))))));
  second = max(second, max(dot(q, vec3(-e, e, e)), max(dot(q, vec3(e, -e, e)), dot(q, vec3(e, e, -e)))));
  float patch_edge = pentagon - (first * 0.985 + 0.0155);
  float blur = max(fwidth(patch_edge), 0.004);
  float dark = smoothstep(-blur, blur, patch_edge);
  float seam = (1.0 - smoothstep(0.012, 0.012 + 2.0 * blur, first - second)) * (1.0 - dark);
  vec3 albedo = mix(vec3(0.93, 0.93, 0.90), vec3(0.035, 0.045, 0.075), dark);
  albedo = mix(albedo, vec3(0.30, 0.31, 0.33), 0.75 * seam);
  vec3 n = normalize(v_normal);
  vec3 light = shade(Surface(albedo, 0.32, 0.0), v_position, n, v_shadow, 1.0);
  o_colour = scene_output((light + albedo * 0.22) * exp(-u_fade * v_position.z), 1.0);  // a little of its own: never lost in a shadow
}
