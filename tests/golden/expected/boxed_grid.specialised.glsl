// ---- the scene ----
// S
bool negative_0(vec3 p) {
  vec3 q = p;
  return in_box(q, vec3(-0.5, -0.75, -0.25), vec3(0.75, 0.5, 0.5)) && textureLod(grid_atlas, q * vec3(0.6545454, 0.6857143, 1.037037) + vec3(0.4181818, 0.5857143, 0.37037036), 0.0).r <= 0.0;
}

// A
void object_0(vec3 p, uint level) {
  uint region;
  if (negative_0(p)) {
    region = 1u;  // IN
  } else {
    region = 0u;  // OUT
  }
  uint number = 0u;
  if (region == 0u) number = 2u;
  if (region == 1u) number = 1u;
  if (number != 0u) answer(region, number, p, level);
}

vec4 color_of(uint region, vec3 p) {
  vec4 color = vec4(0.0);
  if (region == 0u) color = vec4(0.0, 0.0, 1.0, 1.0);  // OUT
  if (region == 1u) color = vec4(1.0, 0.0, 0.0, 1.0);  // IN
  return color;
}

void evaluate(vec3 p) { object_0(p, 0u); }
