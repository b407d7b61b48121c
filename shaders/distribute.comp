#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/queues.glsl"
// After a stage: its pixels go to the stages that they go on to. An invocation takes a run of them, so that there are few
// atomics (shaders/pixel_list.glsl).

const uint run = uint(DMVV_PIXELS_BLOCK);

void main() {
  uint first = gl_GlobalInvocationID.x * run, end = min(first + run, pixels_of_stage(this_step.stage));
  uint next[run];
  uint stages = 0u;
  for (uint i = 0u; i < run; ++i) {
    next[i] = first + i < end ? next_stages[first + i] : 0u;
    stages |= 1u << next[i];
  }
  for (uint left = subgroupOr(stages) & ~1u; left != 0u; left &= left - 1u) {
    uint stage = uint(findLSB(left)), count = 0u;
    for (uint i = 0u; i < run; ++i) count += uint(next[i] == stage);
    uint before = subgroupExclusiveAdd(count), sum = subgroupAdd(count), slot = 0u;
    if (subgroupElect()) slot = atomicAdd(queues.header.counts[stage], sum);
    slot = subgroupBroadcastFirst(slot) + before;
    for (uint i = 0u; i < run; ++i) {
      if (next[i] == stage) queues.pixels[queue_entry(stage, slot++)] = pixel_of_stage(this_step.stage, first + i);
    }
  }
}
