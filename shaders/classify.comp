#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/pixel_list.glsl"
#include "shaders/verdicts.glsl"
// Lists the pixels that show a surface: those of decided cells to be painted, the others to be evaluated. In place of
// `list`. Nothing else happens here: lavapipe pays for all code, in every pixel.

// What becomes of a pixel, and what is known of it: its outcome, or the open cell that is to be told.
#define DMVV_NOTHING uint(DMVV_LISTS_OF_PIXELS)
uint judge_pixel(uvec2 pixel, out uint known) {
  known = DMVV_NO_CELL;
  if (!is_in_picture(pixel)) return DMVV_NOTHING;
  uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  if (surface.w == 0u) return DMVV_NOTHING;
  vec3 p = surface_point(surface);
  uint cell = find_verdict(p, 0u);
  uint word = verdict_words[cell];
  bool is_still = (word & (DMVV_VERDICT_DECIDED | DMVV_VERDICT_STILL)) != 0u;
  bool is_proven = all(lessThanEqual(abs(p), vec3(1.0)));  // of points outside of the cube nothing is
  if (frame.keeps_still != 0u && is_still && is_proven) return DMVV_NOTHING;
  uint counted = cell, first_outcome = 0u;
  if (!is_still && frame.first_span_word != 0u) {
    cell = find_verdict(p, frame.first_span_word);
    word = verdict_words[cell];
    first_outcome = frame.first_span_outcome;
    if (frame.counts_both == 0u || ((pixel.x + pixel.y) & 1u) != 0u) counted = cell;
  }
  bool is_decided = (word & DMVV_VERDICT_DECIDED) != 0u;
  bool paints = is_proven && is_decided && ((word & DMVV_VERDICT_BITMAP) == 0u || frame.paints_bitmaps != 0u);
  known = paints ? first_outcome + (word & DMVV_VERDICT_VALUE) : is_proven && !is_decided ? counted : DMVV_NO_CELL;
  return paints ? DMVV_TO_PAINT : is_leader(pixel) ? DMVV_LEADERS_OF_TILES : DMVV_TO_EVALUATE;
}

void main() {
  uvec2 first = first_of_run();
  uint kinds[DMVV_PIXELS_BLOCK], known[DMVV_PIXELS_BLOCK];
  uint evaluated = 0u, leaders = 0u, painted = 0u;
  for (uint x = 0u; x < DMVV_RUN; ++x) {
    kinds[x] = judge_pixel(first + uvec2(x, 0u), known[x]);
    evaluated += uint(kinds[x] == DMVV_TO_EVALUATE);
    leaders += uint(kinds[x] == DMVV_LEADERS_OF_TILES);
    painted += uint(kinds[x] == DMVV_TO_PAINT);
  }
  evaluated = reserve(DMVV_TO_EVALUATE, evaluated);
  leaders = reserve(DMVV_LEADERS_OF_TILES, leaders);
  painted = reserve(DMVV_TO_PAINT, painted);
  for (uint x = 0u; x < DMVV_RUN; ++x) {
    if (kinds[x] == DMVV_NOTHING) continue;
    uint slot = kinds[x] == DMVV_TO_PAINT ? painted++ : kinds[x] == DMVV_TO_EVALUATE ? evaluated++ : leaders++;
    uint entry = entry_of(kinds[x], slot);
    list_pixel(first + uvec2(x, 0u), entry);
    known_of[entry] = known[x];
  }
}
