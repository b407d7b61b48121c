// What every generated evaluation shares: the hit it reports, the standard cube, placements and lookups.
// Comes after shaders/records.h and the bindings. Set by the generator: DMVV_DEPTH (levels), DMVV_QUERY_PATH (record the way
// to the region), DMVV_LISTS (there are lists to search).

// The answer at one point. hit_number 0: nothing found (yet).
uint hit_number = 0u;
uint hit_region = 0u;          // index of the region that answers
vec3 hit_p = vec3(0.0);        // the point in that region's object
// Of SDFs whose seeds are searched as one list (compiler/passes/seed_chains.h), those of the last search: which is the first that is
// negative; how many there are: none.
uint first_negative = 0u;
// A loop ended before its list did: lavapipe grants a group of points 65,535 rounds in all. Whether a loop came to its
// end is noted within it: what follows from its condition, the driver's compiler takes for granted behind it.
bool hit_unfinished = false;
#ifdef DMVV_STAGE
uint next_stage = 0u;  // where the point goes on; 0: nowhere
#endif
#ifdef DMVV_QUERY_PATH
uint hit_levels = 0u;
uint hit_path[2 * DMVV_DEPTH];  // (region, candidate) a level
#endif

#ifdef DMVV_QUERY_MEDIUM
mat3 hit_linear = mat3(1.0);  // a step in the root -> the step in that object
void note_frame();            // shaders/reach.glsl
#endif

void answer(uint region, uint number, vec3 p, uint level) {
  hit_number = number;
  hit_region = region;
  hit_p = p;
#ifdef DMVV_QUERY_MEDIUM
  note_frame();
#endif
#ifdef DMVV_QUERY_PATH
  hit_levels = level + 1u;
  hit_path[2u * level] = region;
  hit_path[2u * level + 1u] = 0u;
#endif
}

// Notes by which candidate the answer below `level` was reached.
void came_through(uint region, uint candidate, uint level) {
#ifdef DMVV_QUERY_PATH
  hit_path[2u * level] = region;
  hit_path[2u * level + 1u] = candidate;
#endif
}

bool in_box(vec3 q, vec3 lo, vec3 hi) { return all(greaterThanEqual(q, lo)) && all(lessThanEqual(q, hi)); }
bool in_cube(vec3 q) { return all(lessThanEqual(abs(q), vec3(1.0))); }
// PlacementRecord::extent
vec3 extent_of(uint bits) { return vec3((uvec3(bits, bits >> 10u, bits >> 20u) & 1023u) + 1u) * 0.0009765625; }
bool in_extent(vec3 q, vec3 extent) { return all(lessThanEqual(abs(q), extent)); }
vec3 wrap_cube(vec3 q) { return q - 2.0 * floor((q + 1.0) * 0.5); }

vec3 apply(AffineRows a, vec3 p) {
  return vec3(dot(a.x.xyz, p) + a.x.w, dot(a.y.xyz, p) + a.y.w, dot(a.z.xyz, p) + a.z.w);
}

#ifdef DMVV_LISTS
// The range of the point's cell in lists.
uvec2 find_cell(vec3 p, vec3 lo, vec3 cells_per_unit, uvec3 size, uint first_cell) {
  uvec3 c = uvec3(clamp(floor((p - lo) * cells_per_unit), vec3(0.0), vec3(size - 1u)));
  uint cell = first_cell + (c.z * size.y + c.y) * size.x + c.x;
  return uvec2(cell_at(cell), cell_at(cell + 1u));
}
#endif
