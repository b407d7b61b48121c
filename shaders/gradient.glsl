// The gradient of what decided a boundary (DMVV_QUERY_GRADIENT), as a vector in the root. Comes after the evaluation and
// shaders/walk.glsl or, in its place, `call_function`. Sources of grids: central differences over a voxel, so that it has
// no steps. Set by the generator: DMVV_GRIDS, DMVV_FILTER, DMVV_FUNCTIONS.

// Of functions: half the distance of the points whose values are compared, in their frame.
const float function_step = 0.00048828125;

#ifdef DMVV_GRIDS
float grid_value(uint sdf, vec3 q) {
  vec3 at = q * sdfs[sdf].atlas_scale.xyz + sdfs[sdf].atlas_offset.xyz;
#ifdef DMVV_FILTER
  return sample_grid(at);
#else
  return textureLod(grid_atlas, at, 0.0).r;
#endif
}

vec3 grid_gradient(uint sdf, vec3 q) {
  vec3 lo = sdfs[sdf].box_lo.xyz, hi = sdfs[sdf].box_hi.xyz;
#ifdef DMVV_FILTER
  vec3 voxel = 1.0 / sdfs[sdf].atlas_scale.xyz;
#else
  vec3 voxel = 1.0 / (sdfs[sdf].atlas_scale.xyz * vec3(textureSize(grid_atlas, 0)));
#endif
  vec3 before = max(q - voxel, lo), behind = min(q + voxel, hi);
  vec3 difference = vec3(grid_value(sdf, vec3(behind.x, q.yz)) - grid_value(sdf, vec3(before.x, q.yz)),
                         grid_value(sdf, vec3(q.x, behind.y, q.z)) - grid_value(sdf, vec3(q.x, before.y, q.z)),
                         grid_value(sdf, vec3(q.xy, behind.z)) - grid_value(sdf, vec3(q.xy, before.z)));
  return difference / (behind - before);
}
#endif

#ifdef DMVV_FUNCTIONS
// A tape may tell no more than a side: then its iso stands for the value.
vec3 function_gradient(uint sdf, vec3 q) {
  vec3 gradient = vec3(0.0);
  int i = 0;
  do {
    vec3 axis = vec3(equal(ivec3(i >> 1), ivec3(0, 1, 2)));
    float side = (i & 1) == 0 ? 1.0 : -1.0;
    float value = call_function(sdfs[sdf].function, q + side * function_step * axis);
    value = abs(value) < 1.0e37 ? value - sdfs[sdf].box_lo.w : 0.0;
    gradient += side * value * axis;
  } while (++i < 6);
  return gradient;
}
#endif

vec3 decided_gradient() {
  if (decider == DMVV_NO_DECIDER) return vec3(0.0);
  vec3 gradient = decider_p;
  mat3 linear = decider_linear;
  if (decider != DMVV_WALL) {
    uint sdf = decider & ~DMVV_AT_SOURCE;
    vec3 q = decider_p;
    if ((decider & DMVV_AT_SOURCE) == 0u) {
      AffineRows a = placement_affine(sdfs[sdf].first_placement);
      q = apply(a, q);
      linear = linear_of(a) * linear;
    }
#ifdef DMVV_GRIDS
    if (sdfs[sdf].function == DMVV_NO_FUNCTION) gradient = grid_gradient(sdf, q);
#endif
#ifdef DMVV_FUNCTIONS
    if (sdfs[sdf].function != DMVV_NO_FUNCTION) gradient = function_gradient(sdf, q);
#endif
  }
  return gradient * linear;
}
