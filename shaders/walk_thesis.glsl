// The traversal of the published implementation over the records, with its errors (spec/thesis.md): a baseline to
// compare with, never a promise. Comes after shaders/evaluate.glsl, in place of shaders/walk.glsl.

const float thesis_threshold = 0.51;  // of a value that maps -1..1 to 0..1: boundaries stand at +0.02
const float thesis_shrink = 0.001;    // of an index coordinate in 0..1
const int thesis_steps = 512;

// The cell of b, a point in the index's cube: cells hold (first placement, count), z fastest.
uvec2 thesis_cell(LookupRecord l, vec3 b) {
  uvec3 c = uvec3(max((b * 0.5 + 0.5 - thesis_shrink) * vec3(l.size_x, l.size_y, l.size_z), 0.0));
  uint cell = l.first_cell + (c.x * l.size_y + c.y) * l.size_z + c.z;
  return uvec2(cells[2u * cell], cells[2u * cell + 1u]);
}

// The stored value at a local point q; `p` is the point that snippets get. Offsets move the value, not the threshold.
float thesis_value(uint sdf, vec3 q, vec3 p) {
  if (!in_box(q, sdfs[sdf].box_lo.xyz, sdfs[sdf].box_hi.xyz)) return 1.0;
  float offset = 0.5 * sdfs[sdf].box_lo.w;
#ifdef DMVV_FUNCTIONS
  if (sdfs[sdf].function != DMVV_NO_FUNCTION) return 0.5 * call_function(sdfs[sdf].function, p) + 0.5 - offset;
#endif
#ifdef DMVV_GRIDS
  return textureLod(grid_atlas, q * sdfs[sdf].atlas_scale.xyz + sdfs[sdf].atlas_offset.xyz, 0.0).r - offset;
#else
  return 1.0;
#endif
}

float thesis_sample(uint sdf, vec3 p) {
  if (sdfs[sdf].kind != DMVV_KIND_SEEDED) {
    vec3 q = apply(placements[sdfs[sdf].first_placement].local_from_object, p);
    if (sdfs[sdf].kind == DMVV_KIND_TILED) q = wrap_cube(q);
    return thesis_value(sdf, q, q);
  }
  uvec2 range = thesis_cell(sdfs[sdf].lookup, p);
  float least = 1.0;
  uint i = 0u;
  for (; i < range.y; ++i) {
    vec3 q = apply(placements[range.x + i].local_from_object, p);
    least = min(thesis_value(sdf, q, p), least);  // p: the point before seeding
  }
  hit_unfinished = hit_unfinished || i < range.y;
  return least;
}

void walk(uint object, vec3 p, uint level) {
  uint node = objects[object];
  uint i = 0u;    // the placement being asked, up to end
  uint end = 0u;
  vec3 outer_p = p;  // the one point that is remembered: that of the region whose candidates are asked
  uint embedding = DMVV_NO_REGION;  // that region
  vec3 embedding_p = p;
  uint embedding_level = level;
  uint top = level;
  bool done = false;
  int b = 0;
  for (; b < thesis_steps && !done; ++b) {
    bool next = !in_cube(p);
    if (!next) {
      if ((node & DMVV_REGION_BIT) == 0u) {
        node = thesis_sample(nodes[node].sdf, p) > thesis_threshold ? nodes[node].positive : nodes[node].negative;
      }
      if ((node & DMVV_REGION_BIT) != 0u) {
        uint region = node & ~DMVV_REGION_BIT;
        if (regions[region].group_count == 0u) {
          next = regions[region].number == 0u;
          if (!next) {
            answer(region, regions[region].number, p, top);
            done = true;
          }
        } else {  // what was asked so far is forgotten
          embedding = region;
          embedding_p = p;
          embedding_level = top;
          vec3 box_p = apply(groups[regions[region].first_group].box_from_object, p);
          uvec2 range = uvec2(0u);
          if (in_cube(box_p)) range = thesis_cell(groups[regions[region].first_group].lookup, box_p);
          done = range.y == 0u;
          if (!done) {
            i = range.x;
            end = range.x + range.y;
            outer_p = p;
            came_through(region, placements[i].extent, top);
            top = top + 1u;
            node = objects[placements[i].object];
            p = apply(placements[i].local_from_object, outer_p);
            if (placements[i].tiled != 0u) p = wrap_cube(p);  // of a list's first candidate only
          }
        }
      }
    }
    if (next) {
      ++i;
      done = i >= end;
      if (!done) {
        came_through(embedding, placements[i].extent, top - 1u);
        node = objects[placements[i].object];
        p = apply(placements[i].local_from_object, outer_p);
      }
    }
  }
  hit_unfinished = hit_unfinished || (!done && b < thesis_steps);
  if (hit_number == 0u && embedding != DMVV_NO_REGION && regions[embedding].number != 0u) {
    answer(embedding, regions[embedding].number, embedding_p, embedding_level);
  }
}
