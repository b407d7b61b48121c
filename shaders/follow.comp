#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/pixel_list.glsl"
// Gives pixels that are near enough to their tile's leader its answer; the others are left to be evaluated.

// Of the distance between two points: shaders compute it, and how far an answer holds, in float32.
const float rounding = 1.0001;

bool follows(uvec2 pixel) {
  ivec2 tile = ivec2(pixel / DMVV_LEADER_TILE);
  uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  vec3 p = surface_point(surface);
  vec4 place = imageLoad(leader_place, tile);
  bool is_within = all(lessThanEqual(abs(p), vec3(1.0))) && rounding * distance(p, place.xyz) <= place.w;
  if (!is_within) return false;
  uint region = imageLoad(leader_region, tile).x;
  vec4 color = shade(imageLoad(leader_color, tile), surface);
  store_pixel(pixel, region != 0u ? color : vec4(0.0), region, false);
  return true;
}

void main() {
  uint first = gl_GlobalInvocationID.x * DMVV_RUN, end = min(first + DMVV_RUN, list.header.counts[DMVV_TO_EVALUATE]);
  uint left = 0u;
  for (uint x = 0u; x < DMVV_RUN; ++x) {
    if (first + x < end && !follows(listed_pixel(first + x))) left |= 1u << x;
  }
  uint slot = reserve(DMVV_LEFT, bitCount(left));
  uint to = entry_of(DMVV_LEFT, slot);
  for (uint bits = left, i = to; bits != 0u; bits &= bits - 1u) list.entries[i++] = list.entries[first + findLSB(bits)];
  if (frame.hits_to_split != 0u) {
    for (uint bits = left, i = to; bits != 0u; bits &= bits - 1u) known_of[i++] = known_of[first + findLSB(bits)];
  }
}
