#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/verdicts.glsl"
// Colours the pixels of cells that are decided.

#ifdef DMVV_BITMAPS
layout(set = 0, binding = DMVV_BIND_BITMAP_ATLAS) uniform sampler3D bitmap_atlas;
#endif

vec4 color_of_outcome(uint outcome, vec3 p) {
  vec4 color = outcomes[outcome].color;
#ifdef DMVV_BITMAPS
  AffineRows a = outcomes[outcome].texture_from_object;
  vec3 q = vec3(dot(a.x.xyz, p) + a.x.w, dot(a.y.xyz, p) + a.y.w, dot(a.z.xyz, p) + a.z.w);
  vec3 slot = fract((q + 1.0) * 0.5) * outcomes[outcome].slot_scale.xyz + outcomes[outcome].slot_offset.xyz;
  vec4 texel = textureLod(bitmap_atlas, slot, 0.0);
  if (outcomes[outcome].slot_scale.w != 0.0) color = vec4(texel.rgb, texel.a * color.a);
#endif
  return color;
}

void main() {
  if (gl_GlobalInvocationID.x >= list.header.counts[DMVV_TO_PAINT]) return;
  uint entry = entry_of(DMVV_TO_PAINT, gl_GlobalInvocationID.x);
  uvec2 pixel = listed_pixel(entry);
  uint outcome = known_of[entry];
  uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  uint number = outcomes[outcome].number;
  vec4 color = shade(color_of_outcome(outcome, surface_point(surface)), surface);
  store_pixel(pixel, number != 0u ? color : vec4(0.0), number, false);
}
