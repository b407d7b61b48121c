#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/verdicts.glsl"
// Lists the pixels that show a surface: those of decided cells to be painted, the others to be evaluated. In place of
// `list`. Nothing else happens here: lavapipe pays for all code, in every pixel.

void main() {
  uvec2 pixel;
  if (!find_pixel(pixel)) return;
  uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  if (surface.w == 0u) return;
  vec3 p = surface_point(surface);
  uint cell = find_verdict(p, 0u);
  uint word = verdict_words[cell];
  bool is_still = (word & (DMVV_VERDICT_DECIDED | DMVV_VERDICT_STILL)) != 0u;
  bool is_proven = all(lessThanEqual(abs(p), vec3(1.0)));  // of points outside of the cube nothing is
  if (params.keeps_still != 0u && is_still && is_proven) return;
  uint counted = cell, first_outcome = 0u;
  if (!is_still && params.first_span_word != 0u) {
    cell = find_verdict(p, params.first_span_word);
    word = verdict_words[cell];
    first_outcome = params.first_span_outcome;
    if (params.counts_both == 0u || ((pixel.x + pixel.y) & 1u) != 0u) counted = cell;
  }
  bool is_decided = (word & DMVV_VERDICT_DECIDED) != 0u;
  bool paints = is_proven && is_decided && ((word & DMVV_VERDICT_BITMAP) == 0u || params.paints_bitmaps != 0u);
  uint known = paints ? first_outcome + (word & DMVV_VERDICT_VALUE) : is_proven && !is_decided ? counted : DMVV_NO_CELL;
  list_pixel(pixel, paints ? DMVV_TO_PAINT : DMVV_TO_EVALUATE, known);
}
