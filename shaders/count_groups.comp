#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
// After `list` or `classify`, once: the groups that an indirect dispatch of `pixels` has.

void main() {
  if (gl_GlobalInvocationID.x != 0u) return;
  list.header.groups_x = (list.header.count + DMVV_PIXELS_GROUP_SIZE - 1u) / DMVV_PIXELS_GROUP_SIZE;
}
