// How far an answer holds: while it is found, what each step says of the points nearby is kept. Comes after
// shaders/evaluate.glsl, in programs whose generator was told how steep their sources are (compiler/proofs/steepness.h).
// DMVV_QUERY_RADIUS: the kernel asks how far. DMVV_QUERY_GRADIENT: it asks what decides the boundary nearest to the point.
// DMVV_QUERY_MEDIUM: it asks for the frame of the answer. In the other kernels all of this is nothing.
#if defined(DMVV_QUERY_RADIUS) || defined(DMVV_QUERY_GRADIENT)
#if defined(DMVV_QUERY_GRADIENT) || defined(DMVV_QUERY_MEDIUM)
#define DMVV_FRAMES
#endif

// All points within this distance of the point (root coordinates) get the same answer; not positive: nothing is known.
float reach = 3.0e38;
// The same if nothing was rounded, as far as boundaries go: close to one, it falls to 0 as evenly as the source does.
float margin = 3.0e38;

// The frame that points are in: a step in the root is at most so many times as long here; and how far a point here may be
// off, as a step in the root.
struct Local {
  float stretch;
  float error;
#ifdef DMVV_FRAMES
  mat3 linear;  // a step in the root -> the step here
#endif
};

Local local_of(float stretch, float error, mat3 linear) {
#ifdef DMVV_FRAMES
  return Local(stretch, error, linear);
#else
  return Local(stretch, error);
#endif
}
Local local = local_of(1.0, 0.0, mat3(1.0));

// Before another point is asked.
void forget() {
  hit_number = 0u;
  first_negative = 0u;
  reach = margin = 3.0e38;
  local = local_of(1.0, 0.0, mat3(1.0));
}

#ifdef DMVV_QUERY_MEDIUM
void note_frame() { hit_linear = local.linear; }
#endif

#ifdef DMVV_QUERY_GRADIENT
// What the nearest boundary is of, as far as is known: the source of an SDF, or the wall of a box.
uint decider = DMVV_NO_DECIDER;
vec3 decider_p = vec3(0.0);  // the point there, or for a wall its normal
mat3 decider_linear = mat3(1.0);
float decider_distance = 3.0e38;

// Most walls are no boundaries: so much nearer than any source one must be, in root units.
const float least_wall = 1e-5;

void decide(float distance, uint what, vec3 p) {
  if (!(distance / local.stretch < decider_distance)) return;
  decider_distance = distance / local.stretch;
  decider = what;
  decider_p = p;
  decider_linear = local.linear;
}
vec3 wall_normal(vec3 q, vec3 d) {
  vec3 is_nearest = vec3(equal(d, vec3(max(d.x, max(d.y, d.z)))));
  return is_nearest * mix(vec3(-1.0), vec3(1.0), greaterThan(q, vec3(0.0)));
}
#else
const float least_wall = 0.0;
void decide(float distance, uint what, vec3 p) {}
vec3 wall_normal(vec3 q, vec3 d) { return vec3(0.0); }
#endif

// The answer may change once some quantity has changed by `distance`; that quantity changes at most `slope` per unit of the
// current frame. Shrinks `reach` accordingly.
void limit(float distance, float slope) {
  float steps = distance / (slope * local.stretch) - 2.0 * local.error;
  reach = steps >= reach ? reach : steps < reach ? steps : -1.0;  // of NaN: nothing is known
}

void near_boundary(float distance) { margin = min(margin, distance / local.stretch); }

// What limits a part of an evaluation, apart from the rest.
struct Limits {
  float reach, margin;
};
Limits take_limits() {
  Limits limits = Limits(reach, margin);
  reach = margin = 3.0e38;
  return limits;
}
void keep(Limits limits) {
  reach = min(reach, limits.reach);
  margin = min(margin, limits.margin);
}
// A test and what was asked behind it (whose limits are those that hold now): the answer is known if the test comes out so
// (`is_known`); the other one may be the same (`is_same`).
void choose(Limits test, bool is_known, bool is_same) {
  bool both = is_known && is_same;
  reach = both ? max(reach, test.reach) : is_known ? test.reach : is_same ? reach : min(reach, test.reach);
  margin = both ? max(margin, test.margin) : is_known ? test.margin : is_same ? margin : min(margin, test.margin);
}

// The value is that of the source of `sdf` (an index into sdfs, with DMVV_AT_SOURCE where p is a point of its own frame).
// Of values nearer to iso than `widths` it changes at most by 1 / flatness (compiler/proofs/steepness.h).
bool below(float value, float iso, vec2 widths, vec3 flatness, float error, uint sdf, vec3 p) {
  float u = abs(value - iso) - error;
  limit(dot(vec3(min(u, widths.x), clamp(u - widths.x, 0.0, widths.y - widths.x), max(u - widths.y, 0.0)), flatness), 1.0);
  near_boundary(abs(value - iso) * flatness.x);
  decide(abs(value - iso) * (flatness.x > 1e-20 ? flatness.x : 1.0), sdf, p);  // of an unknown slope: as of a distance
  return value <= iso;
}

// To the next wall of a box beyond which something is not asked.
void limit_box(vec3 q, vec3 lo, vec3 hi, float slope, float error) {
  vec3 d = max(lo - q, q - hi);
  vec3 outside = max(d, vec3(0.0));
  float within = max(d.x, max(d.y, d.z)), wall = within > 0.0 ? length(outside) : -within;
  limit(wall - error, slope);
  near_boundary(wall);
  decide(wall + least_wall * local.stretch, DMVV_WALL, wall_normal(q - 0.5 * (lo + hi), d));
}
void limit_cube(vec3 q, float slope, float error) { limit_box(q, vec3(-1.0), vec3(1.0), slope, error); }

// To where q is wrapped: beyond it other values begin.
void limit_tile(vec3 q) {
  vec3 a = abs(q);
  limit(1.0 - max(a.x, max(a.y, a.z)), 1.0);
}

// To where a lookup cell's list ends, a margin behind its next wall; behind the grid's own walls nothing new is listed. An
// empty list goes on as far as all lists around are empty.
#ifdef DMVV_GAPS
void limit_cell(vec3 p, vec3 lo, vec3 cells_per_unit, uvec3 size, uint first_cell) {
  vec3 f = (p - lo) * cells_per_unit;
  vec3 c = clamp(floor(f), vec3(0.0), vec3(size - 1u));
  uvec3 i = uvec3(c);
  float rings = max(float(gap_at(first_cell + (i.z * size.y + i.y) * size.x + i.x)) - 1.0, 0.0);
  vec3 below_p = mix(f - c + rings, vec3(3.0e38), lessThanEqual(c - rings, vec3(0.0)));
  vec3 above_p = mix(c + 1.0 - f + rings, vec3(3.0e38), greaterThanEqual(c + rings, vec3(size - 1u)));
  vec3 d = (min(below_p, above_p) + DMVV_CELL_MARGIN - 4e-7 * vec3(size)) / cells_per_unit;
  limit(min(d.x, min(d.y, d.z)), 1.0);
}
#endif

mat3 linear_of(AffineRows a) { return transpose(mat3(a.x.xyz, a.y.xyz, a.z.xyz)); }
mat3 within(Local outer, mat3 linear) {
#ifdef DMVV_FRAMES
  return linear * outer.linear;
#else
  return linear;
#endif
}

// A frame within `outer`. `skew` is what the largest stretch is of the longest row; `error` what a point is off there, as a
// step in the outer frame.
Local placed(Local outer, AffineRows a, float skew, float error) {
  float longest = max(dot(a.x.xyz, a.x.xyz), max(dot(a.y.xyz, a.y.xyz), dot(a.z.xyz, a.z.xyz)));
  return local_of(outer.stretch * skew * sqrt(longest), outer.error + error / outer.stretch, within(outer, linear_of(a)));
}
Local scaled(Local outer, float stretch, float error, mat3 linear) {
  return local_of(outer.stretch * stretch, outer.error + error / outer.stretch, within(outer, linear));
}

#else

struct Local {
  float unused;
};
Local local = Local(0.0);
void limit(float distance, float slope) {}
bool below(float value, float iso, vec2 widths, vec3 flatness, float error, uint sdf, vec3 p) { return value <= iso; }
void limit_box(vec3 q, vec3 lo, vec3 hi, float slope, float error) {}
void limit_cube(vec3 q, float slope, float error) {}
void limit_tile(vec3 q) {}
void limit_cell(vec3 p, vec3 lo, vec3 cells_per_unit, uvec3 size, uint first_cell) {}
mat3 linear_of(AffineRows a) { return mat3(1.0); }
Local placed(Local outer, AffineRows a, float skew, float error) { return outer; }
Local scaled(Local outer, float stretch, float error, mat3 linear) { return outer; }

#endif
