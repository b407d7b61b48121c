#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/verdicts.glsl"
// Tells the cells that left pixels to be evaluated.

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= list.header.counts[this_step.listed_kind]) return;
  uint cell = known_of[entry_of(this_step.listed_kind, i)];
  if (cell != DMVV_NO_CELL && (verdict_words[cell] & DMVV_VERDICT_FINAL) == 0u) count_hit(cell, frame.hits_to_split);
}
