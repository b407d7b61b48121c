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
void object_2(vec3 p, uint level, bool entered) {
  uint region = DMVV_NO_REGION;
  if (entered) {
    if (negative_0(p)) {
      if (negative_1(p)) {
        region = 4u;  // CORE
      } else {
        region = 3u;  // PLASMA
      }
    } else {
      region = 2u;  // NONE
    }
  }
  uint number = 0u;
  if (region == 3u) number = 1u;
  if (region == 4u) number = 2u;
  if (entered && number != 0u) answer(region, number, p, level);
}

// TUBE
void object_1(vec3 p, uint level) {
  // LUMEN: 1 candidates
  {
    vec3 q = p * vec3(2.0);
    bool enter = in_box(q, vec3(-0.8750614), vec3(0.8750614));
    object_2(q, level + 1u, enter);
    if (enter && hit_number != 0u) came_through(1u, 0u, level);
  }
}

// CELL
bool object_2_listed(vec3 p, uint level, bool inside) {
  bool answers = inside || negative_0(p);
  if (inside) {
    uint region;
    if (negative_1(p)) {
      region = 4u;  // CORE
    } else {
      region = 3u;  // PLASMA
    }
    uint number = 0u;
    if (region == 3u) number = 1u;
    if (region == 4u) number = 2u;
    if (number != 0u) answer(region, number, p, level);
  }
  return answers;
}

// ROOT
void object_0(vec3 p, uint level) {
  // BASE: 2 candidates
  {
    uvec2 range = find_cell(p, vec3(-0.80000037, -0.80000037, -0.80000037), vec3(0.6249997, 0.6249997, 0.6249997), uvec3(1u, 1u, 1u), 0u);
    uint i = range.x;
    uint asked = 0u;
    uint c = 0u;
    vec3 q = p;
    bool found = false;
    while (i < range.y && hit_number == 0u && !found) {
      bool held = false;
      for (; i < range.y && !held; ++i) {
        ++asked;
        c = list_at(i);
        q = apply(placement_affine(2u + c), p);
        held = in_extent(q, extent_of(placement_tags(2u + c).z));
      }
      if (held) {
        uint object = placement_tags(2u + c).x;
        if (object == 1u) object_1(q, level + 1u);
        if (object == 2u) found = object_2_listed(q, level + 1u, false);
        if (hit_number != 0u) came_through(0u, c, level);
      }
    }
    hit_unfinished = hit_unfinished || (hit_number == 0u && !found && asked != range.y - range.x);
    if (found) {
      uint object = placement_tags(2u + c).x;
      if (object == 2u) object_2_listed(q, level + 1u, true);
      came_through(0u, c, level);
    }
  }
  if (hit_number == 0u) answer(0u, 3u, p, level);
}

vec4 color_of(uint region, vec3 p) {
  vec4 color = vec4(0.0);
  if (region == 0u) color = vec4(0.0, 0.0, 0.0, 1.0);  // BASE
  if (region == 3u) color = vec4(0.9, 0.8, 0.7, 1.0);  // PLASMA
  if (region == 4u) color = vec4(0.5, 0.1, 0.1, 1.0);  // CORE
  return color;
}

void evaluate(vec3 p) { object_0(p, 0u); }
