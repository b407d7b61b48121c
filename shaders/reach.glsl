// How far an answer holds: while it is found, what each step says of the points nearby is kept. Comes after
// shaders/evaluate.glsl, in programs whose generator was told how steep their sources are (compiler/proofs/steepness.h).
// DMVV_QUERY_RADIUS: the kernel asks; in the others all of this is nothing.
#ifdef DMVV_QUERY_RADIUS

// All points within this distance of the point (root coordinates) get the same answer; not positive: nothing is known.
float reach = 3.0e38;

// The frame that points are in: a step in the root is at most so many times as long here; and how far a point here may be
// off, as a step in the root.
struct Local {
  float stretch;
  float error;
};
Local local = Local(1.0, 0.0);

// The answer may change once some quantity has changed by `distance`; that quantity changes at most `slope` per unit of the
// current frame. Shrinks `reach` accordingly.
void limit(float distance, float slope) {
  float steps = distance / (slope * local.stretch) - 2.0 * local.error;
  reach = steps >= reach ? reach : steps < reach ? steps : -1.0;  // of NaN: nothing is known
}

bool below(float value, float iso, float slope, float error) {
  limit(abs(value - iso) - error, slope);
  return value <= iso;
}

// To the next wall of a box.
void limit_box(vec3 q, vec3 lo, vec3 hi, float slope, float error) {
  vec3 d = max(lo - q, q - hi);
  limit(abs(max(d.x, max(d.y, d.z))) - error, slope);
}
void limit_cube(vec3 q, float slope, float error) {
  vec3 a = abs(q);
  limit(abs(1.0 - max(a.x, max(a.y, a.z))) - error, slope);
}

// To where a lookup cell's list ends, a margin behind its next wall; behind the grid's own walls nothing new is listed.
void limit_cell(vec3 p, vec3 lo, vec3 cells_per_unit, uvec3 size) {
  vec3 f = (p - lo) * cells_per_unit;
  vec3 c = clamp(floor(f), vec3(0.0), vec3(size - 1u));
  vec3 below_p = mix(f - c, vec3(3.0e38), lessThanEqual(c, vec3(0.0)));
  vec3 above_p = mix(c + 1.0 - f, vec3(3.0e38), greaterThanEqual(c, vec3(size - 1u)));
  vec3 d = (min(below_p, above_p) + DMVV_CELL_MARGIN - 4e-7 * vec3(size)) / cells_per_unit;
  limit(min(d.x, min(d.y, d.z)), 1.0);
}

// A frame within `outer`. `skew` is what the largest stretch is of the longest row; `error` what a point is off there, as a
// step in the outer frame.
Local placed(Local outer, AffineRows a, float skew, float error) {
  float longest = max(dot(a.x.xyz, a.x.xyz), max(dot(a.y.xyz, a.y.xyz), dot(a.z.xyz, a.z.xyz)));
  return Local(outer.stretch * skew * sqrt(longest), outer.error + error / outer.stretch);
}
Local scaled(Local outer, float stretch, float error) {
  return Local(outer.stretch * stretch, outer.error + error / outer.stretch);
}

#else

struct Local {
  float unused;
};
Local local = Local(0.0);
void limit(float distance, float slope) {}
bool below(float value, float iso, float slope, float error) { return value <= iso; }
void limit_box(vec3 q, vec3 lo, vec3 hi, float slope, float error) {}
void limit_cube(vec3 q, float slope, float error) {}
void limit_cell(vec3 p, vec3 lo, vec3 cells_per_unit, uvec3 size) {}
Local placed(Local outer, AffineRows a, float skew, float error) { return outer; }
Local scaled(Local outer, float stretch, float error) { return outer; }

#endif
