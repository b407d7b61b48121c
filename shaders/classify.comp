#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
#include "shaders/verdicts.glsl"
// Answers the pixels of cells that are decided, and lists the others that show a surface. In place of `list`.

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

void store_outcome(uvec2 pixel, uint outcome, vec3 p, uvec4 surface) {
  uint number = outcomes[outcome].number;
  store_pixel(pixel, number != 0u ? shade(color_of_outcome(outcome, p), surface) : vec4(0.0), number, false);
}

void main() {
  uvec2 pixel;
  if (!find_pixel(pixel)) return;
  uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  if (surface.w == 0u) return;
  vec3 p = surface_point(surface);
  if (any(greaterThan(abs(p), vec3(1.0)))) {  // of such points nothing is proven
    list_pixel(pixel);
    return;
  }
  uint cell = find_verdict(p, 0u);
  uint word = verdict_words[cell];
  bool is_still = (word & (DMVV_VERDICT_DECIDED | DMVV_VERDICT_STILL)) != 0u;
  if (params.keeps_still != 0u && is_still) return;
  uint counted = cell, first_outcome = 0u;
  if (!is_still && params.first_span_word != 0u) {
    cell = find_verdict(p, params.first_span_word);
    word = verdict_words[cell];
    first_outcome = params.first_span_outcome;
    if (params.counts_both == 0u || ((pixel.x + pixel.y) & 1u) != 0u) counted = cell;
  }
  if ((word & DMVV_VERDICT_DECIDED) != 0u) {
    store_outcome(pixel, first_outcome + (word & DMVV_VERDICT_VALUE), p, surface);
  } else {
    list_pixel(pixel);
    if ((verdict_words[counted] & DMVV_VERDICT_FINAL) == 0u) count_hit(counted, params.hits_to_split);
  }
}
