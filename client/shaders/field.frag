// The turf: calm dark teal in mown bands, markings drawn from their signed distances so that they
// stay sharp at every size, and the ball's contact shadow as a cue of its height. Its surface is
// polished: what was drawn upside down before shines through by the share in its alpha.
in vec3 v_position;
in vec3 v_shadow;
uniform vec2 u_half_field;    // [m]
uniform float u_goal_width;   // [m]
uniform vec3 u_team_colour[2];
uniform vec3 u_team_lamp[2];
uniform vec4 u_ball;          // position, radius [m]; radius 0: none
uniform vec2 u_active_rods[4];  // x, strength; 0: no more of them
out vec4 o_colour;

float box_distance(vec2 p, vec2 half_size) {
  vec2 d = abs(p) - half_size;
  return length(max(d, 0.0)) + min(max(d.x, d.y), 0.0);
}

// Coverage of a line of the width around distance zero.
float line(float distance, float half_width) {
  float blur = max(fwidth(distance), 0.0004);
  return 1.0 - smoothstep(half_width - 0.5 * blur, half_width + 0.7 * blur, abs(distance));
}

float markings(vec2 p) {
  float w = 0.0024;
  float m = line(p.x, w);
  m = max(m, line(length(p) - 0.103, w));
  m = max(m, 1.0 - smoothstep(0.0075, 0.0095, length(p)));
  vec2 q = vec2(u_half_field.x - abs(p.x), p.y);  // from either goal line inwards
  m = max(m, line(box_distance(q, vec2(0.225, 0.5 * u_goal_width + 0.085)), w));
  m = max(m, line(box_distance(q, vec2(0.105, 0.5 * u_goal_width + 0.018)), w));
  m = max(m, 1.0 - smoothstep(0.0055, 0.0075, length(q - vec2(0.160, 0.0))));
  m = max(m, line(length(q - vec2(0.160, 0.0)) - 0.100, w) * step(0.2255, q.x));
  return m;
}

void main() {
  vec2 p = v_position.xy;
  vec2 band = abs(fract(p / vec2(0.150, 2.0) + 0.25) - 0.5);
  float mown = smoothstep(0.245, 0.255, band.x);
  vec3 turf = mix(vec3(0.0030, 0.034, 0.042), vec3(0.0045, 0.046, 0.056), mown);
  float towards = smoothstep(0.35, 1.0, abs(p.x) / u_half_field.x);
  vec3 team = u_team_colour[p.x > 0.0 ? 1 : 0];
  turf += 0.014 * team * towards;
  float edge = min(u_half_field.x - abs(p.x), u_half_field.y - abs(p.y));
  float m = markings(p);

  Surface s = Surface(mix(turf, mix(vec3(0.52, 0.66, 0.70), team, 0.45 * towards), 0.86 * m), 0.80, 0.0);
  float occlusion = mix(0.45, 1.0, smoothstep(0.0, 0.05, edge));
  float contact = 1.0;
  if (u_ball.w > 0.0) {
    float height = max(u_ball.z - u_ball.w, 0.0);
    float radius = u_ball.w * (1.05 + 5.0 * height);
    // It lies away from the lamp: the higher the ball, the further from its shadow.
    vec2 shadow = u_ball.xy - height / u_key_direction.z * u_key_direction.xy;
    float d = length(p - shadow) / radius;
    contact = 1.0 - 0.74 / (1.0 + 9.0 * height) * (1.0 - smoothstep(0.15, 1.15, d));
  }
  vec3 c = shade(s, v_position, vec3(0.0, 0.0, 1.0), v_shadow, occlusion) * contact;
  // A soft lane of light lies under the rod in hand.
  for (int i = 0; i < 4; ++i) {
    if (u_active_rods[i].y <= 0.0) break;
    float lane = (p.x - u_active_rods[i].x) / 0.020;
    c += u_active_rods[i].y * exp(-lane * lane) * vec3(0.16, 0.20, 0.19) * (0.55 + 0.45 * s.albedo.g * 8.0);
  }
  c += m * mix(vec3(0.16, 0.24, 0.26), team, 0.6 * towards) * 0.35;
  // The lamps along the walls and around the goals light the turf at their feet.
  vec2 goal = vec2(u_half_field.x - abs(p.x), max(abs(p.y) - 0.5 * u_goal_width, 0.0));
  c += u_team_lamp[p.y > 0.0 ? 1 : 0] * 0.10 * exp(-22.0 * (u_half_field.y - abs(p.y)));
  c += u_team_lamp[p.x > 0.0 ? 1 : 0] * 0.30 * exp(-20.0 * length(goal));
  float grazing = 1.0 - normalize(u_eye - v_position).z;
  o_colour = vec4(scene_output(c, 1.0).rgb, 0.13 + 0.80 * grazing * grazing);
}
