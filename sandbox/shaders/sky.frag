in vec3 v_ray;
out vec4 o_colour;

void main() { o_colour = vec4(tone_map(sky_colour(normalize(v_ray))), 1.0); }
