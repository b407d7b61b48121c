// What a triangle does to a pixel. Comes after shaders/triangle.glsl.
//
// Of the triangles that are seen in a pixel the nearest one is kept, of those equally near the one with the smallest number. A
// 64-bit atomic maximum tells it at once (DMVV_LONG_ATOMICS; needs GL_EXT_shader_explicit_arithmetic_types_int64 and
// GL_EXT_shader_atomic_int64). Devices without it draw everything twice, first for depths, then for the numbers of triangles that
// have the pixel's depth: to the bit, since the same kernel computes it again.

#ifdef DMVV_LONG_ATOMICS
layout(set = 0, binding = DMVV_RASTER_NEAREST, std430) buffer Nearest { uint64_t nearest[]; };

bool is_first_step() { return true; }

void keep_nearest(uint pixel, uint inverse_depth, uint number) {
  atomicMax(nearest[pixel], uint64_t(inverse_depth) << 32 | uint64_t(number));
}
#else
layout(set = 0, binding = DMVV_RASTER_NEAREST, std430) buffer Nearest { uvec2 nearest[]; };
layout(push_constant) uniform Step { uint raster_step; };

bool is_first_step() { return raster_step == DMVV_STEP_DEPTHS; }

void keep_nearest(uint pixel, uint inverse_depth, uint number) {
  if (is_first_step()) atomicMax(nearest[pixel].y, inverse_depth);
  else if (nearest[pixel].y == inverse_depth) atomicMax(nearest[pixel].x, number);
}
#endif

// `drawn` is the triangle's number | DMVV_DRAWN_*.
void draw_at(Screen screen, uvec2 pixel, Triangle t, bvec3 zero, uint drawn) {
  vec2 middle = vec2(pixel) + screen.corner;
  vec3 weights = weights_at(t, middle, screen.scale);
  bvec3 positive = bvec3(weights.x > 0.0 || (weights.x == 0.0 && zero.x), weights.y > 0.0 || (weights.y == 0.0 && zero.y),
                         weights.z > 0.0 || (weights.z == 0.0 && zero.z));
  precise float sum = weights.x + weights.y + weights.z;
  precise float inverse_depth = sum / (weights.x * t.w.x + weights.y * t.w.y + weights.z * t.w.z);
  bool is_front = !any(positive), is_back = all(positive);
  bool covers = (is_front || is_back) && inverse_depth > 0.0 && inverse_depth * screen.near <= 1.0;
  bool is_cut = (drawn & DMVV_DRAWN_CUT) != 0u;
  if (counts_shells) {
    // The cap is where the ray comes into what is left, or, if the eye is in it, goes out.
    bool is_beyond = !is_cut || is_left(screen.before_cap, middle, inverse_depth) == screen.from_outside;
    bool is_shell = (drawn & DMVV_DRAWN_COUNTED) != 0u && is_beyond;
    if (covers && is_shell && is_first_step()) atomicAdd(shells[pixel_index(screen, pixel)], is_back ? 1 : -1);
  }
  bool is_shown = (drawn & DMVV_DRAWN_SEEN) != 0u && (is_front || (drawn & DMVV_DRAWN_BACKS) != 0u);
  bool is_seen = is_shown && (!is_cut || is_left(screen.all, middle, inverse_depth));
  if (covers && is_seen) keep_nearest(pixel_index(screen, pixel), floatBitsToUint(inverse_depth), ~drawn & DMVV_DRAWN_TRIANGLE);
}
