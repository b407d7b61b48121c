#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/verdicts.glsl"
// Tells the cells that left pixels to be evaluated.

void main() {
  uint entry = gl_GlobalInvocationID.x;
  if (entry >= list.header.counts[DMVV_TO_EVALUATE]) return;
  uint cell = list.entries[entry].y;
  if (cell != DMVV_NO_CELL && (verdict_words[cell] & DMVV_VERDICT_FINAL) == 0u) count_hit(cell, params.hits_to_split);
}
