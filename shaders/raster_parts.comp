#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef DMVV_LONG_ATOMICS
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "shaders/records.h"
#include "shaders/raster.h"
#include "shaders/cuts.glsl"
#include "shaders/triangle.glsl"
#include "shaders/nearest.glsl"
#include "shaders/parts.glsl"
// A part of a large triangle a group, a row of it an invocation.

layout(local_size_x = DMVV_PART_ROWS) in;

void main() {
  Screen screen = this_screen();
  for (uint i = gl_WorkGroupID.x; i < min(part_count, DMVV_MOST_PARTS); i += gl_NumWorkGroups.x) {
    TrianglePart part = parts[i];
    Triangle t = triangle_number(screen, part.drawn & DMVV_DRAWN_TRIANGLE);
    bvec3 zero = counts_zero(t);
    Outline outline = outline_of(screen, t);
    ivec2 corner = ivec2(uvec2(part.place & 0xffffu, part.place >> 16u) * part_px);
    int y = corner.y + int(gl_LocalInvocationID.x);
    ivec2 row = clamp(row_of(outline, y), corner.x, corner.x + int(part_px.x));
    if (y < outline.lo.y || y >= outline.hi.y) row.y = row.x;
    for (int x = row.x; x < row.y; ++x) draw_at(screen, uvec2(x, y), t, zero, part.drawn);
  }
}
