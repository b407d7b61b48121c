#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
// Lists the pixels that show a surface: no other one is evaluated.

void main() {
  uvec2 pixel;
  if (!find_pixel(pixel)) return;
  if (imageLoad(surface_image, ivec2(pixel)).w != 0u) list_pixel(pixel, DMVV_TO_EVALUATE, DMVV_NO_CELL);
}
