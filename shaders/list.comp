#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/pixel_list.glsl"
// Lists the pixels that show a surface: no other one is evaluated.

void main() {
  uvec2 first = first_of_run();
  uint seen = 0u, leaders = 0u;
  for (uint x = 0u; x < DMVV_RUN; ++x) {
    uvec2 pixel = first + uvec2(x, 0u);
    if (!is_in_picture(pixel) || (imageLoad(surface_image, ivec2(pixel)).w == 0u && frame.lists_all == 0u)) continue;
    if (is_leader(pixel)) leaders |= 1u << x;
    else seen |= 1u << x;
  }
  uint slot = reserve(DMVV_TO_EVALUATE, bitCount(seen)), leader_slot = reserve(DMVV_LEADERS_OF_TILES, bitCount(leaders));
  for (; seen != 0u; seen &= seen - 1u) list_pixel(first + uvec2(findLSB(seen), 0u), slot++);
  for (; leaders != 0u; leaders &= leaders - 1u) {
    list_pixel(first + uvec2(findLSB(leaders), 0u), entry_of(DMVV_LEADERS_OF_TILES, leader_slot++));
  }
}
