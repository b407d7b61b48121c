// ---- the scene ----
// WALL
bool negative_0(vec3 p) {
  return textureLod(grid_atlas, p * vec3(0.46153846) + vec3(0.5), 0.0).r <= 0.0;
}

// NUCLEUS
bool negative_1(vec3 p) {
  vec3 q = p * vec3(2.5) + vec3(-0.25, 0.0, 0.0);
  return in_cube(q) && textureLod(grid_atlas, q * vec3(0.46153846) + vec3(0.5), 0.0).r <= 0.0;
}

// CELL
void object_1(vec3 p, uint level, bool entered) {
  uint region = DMVV_NO_REGION;
  if (entered) {
    if (negative_0(p)) {
      if (negative_1(p)) {
        region = 3u;  // CORE
      } else {
        region = 2u;  // PLASMA
      }
    } else {
      region = 1u;  // NONE
    }
  }
  uint number = 0u;
  if (region == 2u) number = 1u;
  if (region == 3u) number = 2u;
  if (entered && number != 0u) answer(region, number, p, level);
}

// TISSUE
void object_0(vec3 p, uint level) {
  // MATRIX: 1 candidates
  {
    vec3 q = wrap_cube(mat3(4.3301272, 0.0, 2.5, 0.0, 3.3333333, 0.0, -2.5, 0.0, 4.3301272) * p);
    bool enter = true;
    object_1(q, level + 1u, enter);
    if (enter && hit_number != 0u) came_through(0u, 0u, level);
  }
  if (hit_number == 0u) answer(0u, 3u, p, level);
}

vec4 color_of(uint region, vec3 p) {
  vec4 color = vec4(0.0);
  if (region == 0u) color = vec4(0.3, 0.6, 0.3, 1.0);  // MATRIX
  if (region == 2u) color = vec4(0.9, 0.8, 0.7, 1.0);  // PLASMA
  if (region == 3u) color = vec4(0.5, 0.1, 0.1, 1.0);  // CORE
  return color;
}

void evaluate(vec3 p) { object_0(p, 0u); }
