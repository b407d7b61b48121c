// The generic walker over the records: the thesis' way (section 3.6), with a stack as deep as the scene's embedding.
// Comes after shaders/evaluate.glsl.

uvec2 find_cell(LookupRecord l, vec3 p) {
  return find_cell(p, l.lo.xyz, l.cells_per_unit.xyz, uvec3(l.size_x, l.size_y, l.size_z), l.first_cell);
}

// Above iso counts as outside; so does NaN.
bool placed_negative(uint sdf, vec3 q) {
  if (!in_box(q, sdfs[sdf].box_lo.xyz, sdfs[sdf].box_hi.xyz)) return false;
#ifdef DMVV_FUNCTIONS
  if (sdfs[sdf].function != DMVV_NO_FUNCTION) return call_function(sdfs[sdf].function, q) <= sdfs[sdf].box_lo.w;
#endif
#ifdef DMVV_GRIDS
  vec3 texel = q * sdfs[sdf].atlas_scale.xyz + sdfs[sdf].atlas_offset.xyz;
#ifdef DMVV_FILTER
  return sample_grid(texel) <= sdfs[sdf].box_lo.w;
#else
  return textureLod(grid_atlas, texel, 0.0).r <= sdfs[sdf].box_lo.w;
#endif
#else
  return false;
#endif
}

bool walk_negative(uint sdf, vec3 p) {
  uint first = sdfs[sdf].first_placement;
  if (sdfs[sdf].kind != DMVV_KIND_SEEDED) {
    vec3 q = apply(placement_affine(first), p);
    if (sdfs[sdf].kind == DMVV_KIND_TILED) q = wrap_cube(q);
    return placed_negative(sdf, q);
  }
  uvec2 range = find_cell(sdfs[sdf].lookup, p);
  uint asked = 0u;
  bool negative = false;
  for (uint i = range.x; i < range.y && !negative; ++i) {
    ++asked;
    negative = placed_negative(sdf, apply(placement_affine(first + list_at(i)), p));
  }
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
};

// Evaluates `object` at p; answers like specialised code does: hit_number stays 0 where the object is empty.
void walk(uint object, vec3 p, uint level) {
#ifdef DMVV_REACH
  limit(0.0, 1.0);  // of what is walked, it is not told how far it holds
#endif
  Frame stack[DMVV_DEPTH];
  int top = 0;
  bool ended = false;
  stack[0] = Frame(p, walk_tree(object, p), 0u, 0u, 0u, 0u);
  while (top >= 0) {
    Frame f = stack[top];
    uint group = regions[f.region].first_group + f.groups_begun;
    if (f.i < f.end) {  // ask the next candidate of the open group
      uint c = list_at(f.i);
      uint placement = groups[group - 1u].first_placement + c;
      stack[top].i = f.i + 1u;
      vec3 q = apply(placement_affine(placement), f.p);
      bool tiled = placement_tags(placement).y != 0u;
      if (tiled) q = wrap_cube(q);
      if (tiled || in_cube(q)) {
        stack[top].candidate = groups[group - 1u].first_number + c;
        top = top + 1;
        stack[top] = Frame(q, walk_tree(placement_tags(placement).x, q), 0u, 0u, 0u, 0u);
      }
    } else if (f.groups_begun < regions[f.region].group_count) {  // open the next group
      stack[top].groups_begun = f.groups_begun + 1u;
      vec3 b = f.p;
      bool asked = true;
      if (groups[group].has_box != 0u) {
        b = apply(groups[group].box_from_object, f.p);
        asked = in_cube(b);
      }
      if (asked) {
        uvec2 range = find_cell(groups[group].lookup, b);
        stack[top].i = range.x;
        stack[top].end = range.y;
      }
    } else if (regions[f.region].number != 0u) {  // nobody answered: the region's own colour counts
      answer(f.region, regions[f.region].number, f.p, level + uint(top));
      for (int k = 0; k < top; ++k) came_through(stack[k].region, stack[k].candidate, level + uint(k));
      ended = true;
      break;
    } else {  // the object is empty here: the next candidate of the enclosing region
      ended = top == 0;
      top = top - 1;
    }
  }
  hit_unfinished = hit_unfinished || !ended;
}
