#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef DMVV_LONG_ATOMICS
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "shaders/records.h"
#include "shaders/raster.h"
#include "shaders/cuts.glsl"
#include "shaders/triangle.glsl"
#include "shaders/nearest.glsl"
#include "shaders/parts.glsl"
// A triangle an invocation. Small ones are drawn at once, large ones in parts later: eight invocations of a CPU take as long
// as their largest triangle.

layout(local_size_x = DMVV_RUN_TRIANGLES) in;
layout(set = 0, binding = DMVV_RASTER_RUNS, std430) readonly buffer Runs { TriangleRun runs[]; };

void divide(Outline outline, uint drawn) {
  uvec2 first = uvec2(outline.lo) / part_px, size = (uvec2(outline.hi) - 1u) / part_px - first + 1u;
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
    Outline outline = outline_of(screen, t);
    there = there && all(lessThan(outline.lo, outline.hi)) &&
            ((drawn & (DMVV_DRAWN_BACKS | DMVV_DRAWN_COUNTED)) != 0u || !outline.is_turned_away);
    ivec2 size = outline.hi - outline.lo;
    bool is_large = there && size.x * size.y > int(DMVV_WHOLE_TRIANGLE_PX);
    bvec3 zero = counts_zero(t);
    int y = outline.lo.y, end = there && !is_large ? outline.hi.y : y;
    ivec2 row = row_of(outline, y);
    while (y < end) {
      if (row.x < row.y) draw_at(screen, uvec2(row.x, y), t, zero, drawn);
      ++row.x;
      if (row.x >= row.y) row = row_of(outline, ++y);
    }
    divide(outline, is_large && is_first_step() ? drawn : 0xffffffffu);
  }
}
