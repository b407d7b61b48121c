#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "shaders/raster.h"
#include "shaders/cuts.glsl"
#include "shaders/triangle.glsl"
#include "shaders/parts.glsl"
// A triangle an invocation. Small ones are drawn at once, large ones in parts later: eight invocations of a CPU take as long
// as their largest triangle.

layout(local_size_x = DMVV_RUN_TRIANGLES) in;
layout(set = 0, binding = DMVV_RASTER_RUNS, std430) readonly buffer Runs { TriangleRun runs[]; };

// Shows its back for certain: the pixels of others decide for themselves.
bool is_turned_away(Screen screen, Triangle t) {
  vec2 a = vec2(t.x.x, t.y.x) / t.w.x, b = vec2(t.x.y, t.y.y) / t.w.y, c = vec2(t.x.z, t.y.z) / t.w.z;
  vec2 ab = (b - a) / screen.scale, ac = (c - a) / screen.scale;
  float margin = 1e-2 * (abs(ab.x) + abs(ab.y) + abs(ac.x) + abs(ac.y));
  return min(min(t.w.x, t.w.y), t.w.z) >= screen.near && ab.x * ac.y - ab.y * ac.x > margin;
}

void divide(Box box, uint drawn) {
  uvec2 first = uvec2(box.lo) / DMVV_PART_PX, size = (uvec2(box.hi) - 1u) / DMVV_PART_PX - first + 1u;
  uint count = drawn != 0xffffffffu ? size.x * size.y : 0u;
  uint before = subgroupExclusiveAdd(count), sum = subgroupAdd(count), slot = 0u;
  if (subgroupElect() && sum != 0u) slot = atomicAdd(part_count, sum);
  slot = subgroupBroadcastFirst(slot) + before;
  uvec2 at = uvec2(0u);
  for (uint i = 0u; i < count; ++i) {
    if (slot + i < DMVV_MOST_PARTS) parts[slot + i] = TrianglePart(drawn, (first.x + at.x) | (first.y + at.y) << 16u);
    at = at.x + 1u < size.x ? uvec2(at.x + 1u, at.y) : uvec2(0u, at.y + 1u);
  }
}

void main() {
  Screen screen = this_screen();
  for (uint r = gl_WorkGroupID.x; r < raster.run_count; r += gl_NumWorkGroups.x) {
    TriangleRun run = runs[r];
    bool there = gl_LocalInvocationID.x < run.count;
    uint drawn = run.first + (there ? gl_LocalInvocationID.x : 0u);
    Triangle t = triangle_number(screen, drawn & DMVV_DRAWN_TRIANGLE);
    Box box = box_of(screen, t);
    there = there && all(lessThan(box.lo, box.hi)) && ((drawn & (DMVV_DRAWN_BACKS | DMVV_DRAWN_COUNTED)) != 0u || !is_turned_away(screen, t));
    uint width = uint(box.hi.x - box.lo.x), count = there ? width * uint(box.hi.y - box.lo.y) : 0u;
    bool is_large = count > DMVV_WHOLE_TRIANGLE_PX;
    bvec3 zero = counts_zero(t);
    ivec2 pixel = box.lo;
    for (uint i = 0u; i < (is_large ? 0u : count); ++i) {
      draw_at(screen, uvec2(pixel), t, zero, drawn);
      pixel = pixel.x + 1 < box.hi.x ? ivec2(pixel.x + 1, pixel.y) : ivec2(box.lo.x, pixel.y + 1);
    }
    divide(box, is_large ? drawn : 0xffffffffu);
  }
}
