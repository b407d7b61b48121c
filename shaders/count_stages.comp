#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/queues.glsl"
// Before each stage whose pixels are counted, once: the groups of indirect dispatches over them.

void main() {
  uint stage = gl_GlobalInvocationID.x;
  if (stage >= DMVV_MOST_STAGES) return;
  const uint group = DMVV_PIXELS_GROUP_SIZE, run = DMVV_PIXELS_BLOCK;
  uint count = pixels_of_stage(stage);
  queues.header.groups[stage] = DispatchGroups((count + group - 1u) / group, 1u, 1u);
  queues.header.runs[stage] = DispatchGroups((count + group * run - 1u) / (group * run), 1u, 1u);
}
