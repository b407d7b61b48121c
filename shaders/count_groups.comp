#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
// After kernels that list pixels, once: the groups of the indirect dispatches.

uint groups_of(uint kind, uint pixels_of_group) { return (list.header.counts[kind] + pixels_of_group - 1u) / pixels_of_group; }

void main() {
  if (gl_GlobalInvocationID.x != 0u) return;
  const uint pixels = DMVV_PIXELS_GROUP_SIZE;
  uint followers = frame.has_leaders != 0u ? pixels * DMVV_PIXELS_BLOCK : pixels;  // `follow` takes runs of them
  list.header.groups[DMVV_TO_EVALUATE].x = groups_of(DMVV_TO_EVALUATE, followers);
  list.header.groups[DMVV_LEFT].x = groups_of(DMVV_LEFT, pixels);
  list.header.groups[DMVV_LEADERS_OF_TILES].x = groups_of(DMVV_LEADERS_OF_TILES, pixels);
  list.header.groups[DMVV_TO_PAINT].x = groups_of(DMVV_TO_PAINT, pixels);
}
