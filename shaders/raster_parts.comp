#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#include "shaders/raster.h"
#include "shaders/cuts.glsl"
#include "shaders/triangle.glsl"
#include "shaders/parts.glsl"
// A part of a large triangle a group, 8 x 4 pixels a round.

layout(local_size_x = 32) in;
const ivec2 round_px = ivec2(8, 4);

// Is the box, half a pixel wider, on the outer side of one edge, whichever side of the triangle is seen?
bool misses(Screen screen, Triangle t, Box box) {
  vec2 lo = vec2(box.lo) - 0.5 + screen.corner, hi = vec2(box.hi) - 0.5 + screen.corner;
  vec3 a = weights_at(t, lo, screen.scale), b = weights_at(t, vec2(hi.x, lo.y), screen.scale);
  vec3 c = weights_at(t, vec2(lo.x, hi.y), screen.scale), d = weights_at(t, hi, screen.scale);
  vec3 least = min(min(a, b), min(c, d)), most = max(max(a, b), max(c, d));
  return any(greaterThan(least, vec3(0.0))) && any(lessThan(most, vec3(0.0)));
}

void main() {
  Screen screen = this_screen();
  ivec2 within = ivec2(gl_LocalInvocationID.x) / ivec2(1, round_px.x) % round_px;
  for (uint i = gl_WorkGroupID.x; i < min(part_count, DMVV_MOST_PARTS); i += gl_NumWorkGroups.x) {
    TrianglePart part = parts[i];
    Triangle t = triangle_number(screen, part.drawn & DMVV_DRAWN_TRIANGLE);
    bvec3 zero = counts_zero(t);
    ivec2 square = ivec2(part.place & 0xffffu, part.place >> 16u) * int(DMVV_PART_PX);
    Box box = box_of(screen, t);
    box = Box(max(box.lo, square), min(box.hi, square + int(DMVV_PART_PX)));
    if (misses(screen, t, box)) box.hi = box.lo;
    for (int y = box.lo.y + within.y; y < box.hi.y; y += round_px.y) {
      for (int x = box.lo.x + within.x; x < box.hi.x; x += round_px.x) draw_at(screen, uvec2(x, y), t, zero, part.drawn);
    }
  }
}
