#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
// After `list` or `classify`, once: the groups of the indirect dispatches.

uint groups_of(uint kind) { return (list.header.counts[kind] + DMVV_PIXELS_GROUP_SIZE - 1u) / DMVV_PIXELS_GROUP_SIZE; }

void main() {
  if (gl_GlobalInvocationID.x != 0u) return;
  list.header.groups_x = groups_of(DMVV_TO_EVALUATE);
  list.header.paint_groups_x = groups_of(DMVV_TO_PAINT);
}
