// The generic walker over the records: the thesis' way (section 3.6), with a stack as deep as the scene's embedding.
// Comes after shaders/evaluate.glsl.

uvec2 find_cell(LookupRecord l, vec3 p) {
  return find_cell(p, l.lo.xyz, l.cells_per_unit.xyz, uvec3(l.size_x, l.size_y, l.size_z), l.first_cell);
}

void limit_cell(LookupRecord l, vec3 p) {
#ifdef DMVV_GAPS
  limit_cell(p, l.lo.xyz, l.cells_per_unit.xyz, uvec3(l.size_x, l.size_y, l.size_z), l.first_cell);
#endif
}

// The frame of a placement within `outer`, whose matrix is known only here: no step is longer there than by the root of the
// largest row sum of A A^T, which is exact for what scales and turns.
Local placed_at(Local outer, AffineRows a) {
  vec3 x = a.x.xyz, y = a.y.xyz, z = a.z.xyz;
  float xy = abs(dot(x, y)), yz = abs(dot(y, z)), zx = abs(dot(z, x));
  float stretch = sqrt(max(dot(x, x) + xy + zx, max(dot(y, y) + xy + yz, dot(z, z) + yz + zx)));
  float largest = max(dot(abs(a.x), vec4(1.0)), max(dot(abs(a.y), vec4(1.0)), dot(abs(a.z), vec4(1.0))));
  return scaled(outer, stretch, 4e-7 * largest / stretch, linear_of(a));
}

// Above iso counts as outside; so does NaN.
bool placed_negative(uint sdf, vec3 q) {
  vec3 lo = sdfs[sdf].box_lo.xyz, hi = sdfs[sdf].box_hi.xyz;
  bool inside = in_box(q, lo, hi);
  float value = 3.0e38;
#ifdef DMVV_GRIDS
  vec3 texel = q * sdfs[sdf].atlas_scale.xyz + sdfs[sdf].atlas_offset.xyz;
#ifdef DMVV_FILTER
  if (inside && sdfs[sdf].function == DMVV_NO_FUNCTION) value = sample_grid(texel);
#else
  if (inside && sdfs[sdf].function == DMVV_NO_FUNCTION) value = textureLod(grid_atlas, texel, 0.0).r;
#endif
#endif
#ifdef DMVV_FUNCTIONS
  if (inside && sdfs[sdf].function != DMVV_NO_FUNCTION) value = call_function(sdfs[sdf].function, q);
#endif
  vec4 flatness = sdfs[sdf].flatness;
  bool negative = inside && below(value, sdfs[sdf].box_lo.w, sdfs[sdf].widths.xy, flatness.xyz, flatness.w,
                                  sdf | DMVV_AT_SOURCE, q);
  if (inside == negative) limit_box(q, lo, hi, 1.0, 0.0);
  return negative;
}

bool walk_negative(uint sdf, vec3 p) {
  uint first = sdfs[sdf].first_placement;
  Local outer = local;
  bool negative = false;
  if (sdfs[sdf].kind != DMVV_KIND_SEEDED) {
    AffineRows a = placement_affine(first);
    vec3 q = apply(a, p);
    local = placed_at(outer, a);
    if (sdfs[sdf].kind == DMVV_KIND_TILED) {
      q = wrap_cube(q);
      limit_tile(q);
    }
    negative = placed_negative(sdf, q);
    local = outer;
    return negative;
  }
  uvec2 range = find_cell(sdfs[sdf].lookup, p);
  limit_cell(sdfs[sdf].lookup, p);
  uint asked = 0u;
  for (uint i = range.x; i < range.y && !negative; ++i) {
    ++asked;
    AffineRows a = placement_affine(first + list_at(i));
    local = placed_at(outer, a);
    negative = placed_negative(sdf, apply(a, p));
  }
  local = outer;
  hit_unfinished = hit_unfinished || (!negative && asked != range.y - range.x);
  return negative;
}

// The region in which p lies, by the object's decision tree.
uint walk_tree(uint object, vec3 p) {
  uint reference = objects[object];
  bool arrived = (reference & DMVV_REGION_BIT) != 0u;
  while ((reference & DMVV_REGION_BIT) == 0u) {
    NodeRecord node = nodes[reference];
    uint next = walk_negative(node.sdf, p) ? node.negative : node.positive;
    if (next == reference) break;  // never in a tree; a device that runs out of rounds must still end
    reference = next;
    arrived = (next & DMVV_REGION_BIT) != 0u;
  }
  hit_unfinished = hit_unfinished || !arrived;
  return reference & ~DMVV_REGION_BIT;
}

// One level of embedding: a point, the region it is in, and how far its candidates have been asked.
struct Frame {
  vec3 p;
  uint region;
  uint groups_begun;  // groups of the region that were opened; the last of them is being asked
  uint i;             // next entry in lists, up to end
  uint end;
  uint candidate;     // number of the candidate that was entered last
  bool tiled;         // entered by a tiling: it has no walls
  Local local;
};

// Evaluates `object` at p; answers like specialised code does: hit_number stays 0 where the object is empty.
void walk(uint object, vec3 p, uint level) {
  Local outer = local;
  Frame stack[DMVV_DEPTH];
  int top = 0;
  bool ended = false;
  stack[0] = Frame(p, walk_tree(object, p), 0u, 0u, 0u, 0u, true, local);
  while (top >= 0) {
    Frame f = stack[top];
    local = f.local;
    uint group = regions[f.region].first_group + f.groups_begun;
    if (f.i < f.end) {  // ask the next candidate of the open group
      uint c = list_at(f.i);
      uint placement = groups[group - 1u].first_placement + c;
      stack[top].i = f.i + 1u;
      AffineRows a = placement_affine(placement);
      vec3 q = apply(a, f.p);
      bool tiled = placement_tags(placement).y != 0u;
      local = placed_at(f.local, a);
      if (tiled) {
        q = wrap_cube(q);
        limit_tile(q);
      } else if (!in_cube(q)) {
        limit_cube(q, 1.0, 0.0);
      }
      if (tiled || in_cube(q)) {
        stack[top].candidate = groups[group - 1u].first_number + c;
        top = top + 1;
        stack[top] = Frame(q, walk_tree(placement_tags(placement).x, q), 0u, 0u, 0u, 0u, tiled, local);
      }
    } else if (f.groups_begun < regions[f.region].group_count) {  // open the next group
      stack[top].groups_begun = f.groups_begun + 1u;
      vec3 b = f.p;
      bool asked = true;
      if (groups[group].has_box != 0u) {
        b = apply(groups[group].box_from_object, f.p);
        asked = in_cube(b);
        local = placed_at(f.local, groups[group].box_from_object);
        limit_cube(b, 1.0, 0.0);
      }
      if (asked) {
        uvec2 range = find_cell(groups[group].lookup, b);
        limit_cell(groups[group].lookup, b);
        stack[top].i = range.x;
        stack[top].end = range.y;
      }
    } else if (regions[f.region].number != 0u) {  // nobody answered: the region's own colour counts
      answer(f.region, regions[f.region].number, f.p, level + uint(top));
      for (int k = 1; k <= top; ++k) {  // what answers ends with the cubes that it stands in
        local = stack[k].local;
        if (!stack[k].tiled) limit_cube(stack[k].p, 1.0, 0.0);
      }
      for (int k = 0; k < top; ++k) came_through(stack[k].region, stack[k].candidate, level + uint(k));
      ended = true;
      break;
    } else {  // the object is empty here: the next candidate of the enclosing region
      ended = top == 0;
      top = top - 1;
    }
  }
  local = outer;
  hit_unfinished = hit_unfinished || !ended;
}
