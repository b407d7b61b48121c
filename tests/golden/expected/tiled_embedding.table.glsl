// ---- the scene ----
vec4 color_of(uint region, vec3 p) {
  vec4 color = regions[region].color;
  return color;
}

void evaluate(vec3 p) { walk(0u, p, 0u); }
