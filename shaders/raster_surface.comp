#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/raster.h"
#include "shaders/cuts.glsl"
#include "shaders/triangle.glsl"
#include "shaders/surface.glsl"
// What each pixel shows: the nearest triangle, or a cap, where the solid is around the cap's point (runtime/surface/raster.cpp).

layout(local_size_x = DMVV_RUN_TRIANGLES) in;
layout(set = 0, binding = DMVV_RASTER_NEAREST, std430) readonly buffer Nearest { uvec2 nearest[]; };
layout(set = 0, binding = DMVV_RASTER_SURFACE, rgba32ui) writeonly uniform uimage2D surface_image;

const float never = 3.0e38;

// Depths [enter, leave] of a ray stay; nothing does if enter > leave. The planes are those that are crossed there.
struct Kept {
  float enter, leave;
  vec4 enter_plane, leave_plane;
};

// All that caps are made of, read once (shaders/cuts.glsl).
struct Section {
  vec3 eye, ray, ray_x, ray_y;
  uint front_count;
  vec4 a, b, c;  // the first planes
};

Section this_section() {
  Section s = Section(raster.eye.xyz, raster.ray.xyz, raster.ray_x.xyz, raster.ray_y.xyz, raster.front_count, vec4(0.0), vec4(0.0),
                      vec4(0.0));
  const bool is_compiled = compiled_cuts != any_cuts;
  if (is_compiled && compiled_cuts > 0u) s.a = raster.cuts[0].plane;
  if (is_compiled && compiled_cuts > 1u) s.b = raster.cuts[1].plane;
  if (is_compiled && compiled_cuts > 2u) s.c = raster.cuts[2].plane;
  return s;
}

void meet(inout Kept kept, vec3 direction, vec4 plane, float gap, bool is_in_front) {
  precise float along = dot(plane.xyz, direction);
  precise float t = gap / along;
  float enter = is_in_front ? (along < 0.0 ? min(t, never) : never) : -never;
  float leave = !is_in_front && along > 0.0 ? t : never;
  if (enter > kept.enter) kept.enter_plane = plane;
  if (leave < kept.leave) kept.leave_plane = plane;
  kept.enter = max(kept.enter, enter);
  kept.leave = min(kept.leave, leave);
}

Kept kept_part(Screen screen, Section s, vec3 direction) {
  Kept kept = Kept(-never, never, vec4(0.0), vec4(0.0));
  if (compiled_cuts != any_cuts) {
    if (compiled_cuts > 0u) meet(kept, direction, s.a, screen.all.a.w, 0u < s.front_count);
    if (compiled_cuts > 1u) meet(kept, direction, s.b, screen.all.b.w, 1u < s.front_count);
    if (compiled_cuts > 2u) meet(kept, direction, s.c, screen.all.c.w, 2u < s.front_count);
  } else {
    for (uint i = 0; i < raster.cut_count; ++i) {
      meet(kept, direction, raster.cuts[i].plane, raster.cuts[i].along.w, i < s.front_count);
    }
  }
  return kept;
}

uvec4 cap_at(Screen screen, Section s, vec2 middle) {
  precise vec3 direction = s.ray + middle.x * s.ray_x + middle.y * s.ray_y;
  Kept kept = kept_part(screen, s, direction);
  float t = screen.from_outside ? kept.enter : kept.leave;
  vec4 plane = screen.from_outside ? kept.enter_plane : kept.leave_plane;
  vec3 p = s.eye + t * direction;
  p -= plane.xyz * (dot(plane.xyz, p) - plane.w);  // onto the plane: t is rounded
  bool stays = kept.enter <= kept.leave && t < never;
  return stays ? pack_surface(p, screen.from_outside ? plane.xyz : -plane.xyz) : uvec4(0u);
}

// By differences from a corner: what all corners share stays exact, so the faces of axis-aligned boxes are flat to the bit.
uvec4 surface_at(Screen screen, uint number, vec2 middle) {
  uvec4 a = corner_texel(number, 0u), b = corner_texel(number, 1u), c = corner_texel(number, 2u);
  vec3 p = uintBitsToFloat(a.xyz), q = uintBitsToFloat(b.xyz), r = uintBitsToFloat(c.xyz);
  vec3 weights = weights_at(triangle_of(screen, p, q, r), middle, screen.scale);
  float sum = weights.x + weights.y + weights.z;
  weights /= sum;
  vec3 normal = weights.x * unfold(unpackSnorm2x16(a.w)) + weights.y * unfold(unpackSnorm2x16(b.w)) + weights.z * unfold(unpackSnorm2x16(c.w));
  return pack_surface(p + weights.y * (q - p) + weights.z * (r - p), sum < 0.0 ? normal : -normal);
}

// A column of pixels, as bits: first what they show, then each kind in a loop of its own. Lavapipe runs all code of a loop in
// each of its rounds, for eight columns at once.
void main() {
  Screen screen = this_screen();
  Section section = this_section();
  uvec2 first = gl_GlobalInvocationID.xy * uvec2(1u, DMVV_COLUMN_PX);
  if (first.x >= screen.size.x) return;
  uint rows = min(DMVV_COLUMN_PX, screen.size.y - first.y), seen = 0u, capped = 0u;
  for (uint y = 0u; y < rows; ++y) {
    uint index = pixel_index(screen, first + uvec2(0u, y));
    bool is_seen = nearest[index].y != 0u;
    // Where the eye is removed, all that stays lies behind the caps; where it is left, all that stays lies before them.
    bool is_capped = counts_shells && (screen.from_outside || !is_seen) && shells[index] != 0;
    if (is_capped) capped |= 1u << y;
    else if (is_seen) seen |= 1u << y;
  }
  for (uint left = seen; left != 0u; left &= left - 1u) {
    uvec2 pixel = first + uvec2(0u, findLSB(left));
    uint number = ~nearest[pixel_index(screen, pixel)].x & DMVV_DRAWN_TRIANGLE;
    imageStore(surface_image, ivec2(pixel), surface_at(screen, number, vec2(pixel) + screen.corner));
  }
  if (counts_shells) {
    for (uint left = capped; left != 0u; left &= left - 1u) {
      uvec2 pixel = first + uvec2(0u, findLSB(left));
      imageStore(surface_image, ivec2(pixel), cap_at(screen, section, vec2(pixel) + screen.corner));
    }
  }
  for (uint left = ~(seen | capped) & ((1u << rows) - 1u); left != 0u; left &= left - 1u) {
    imageStore(surface_image, ivec2(first + uvec2(0u, findLSB(left))), uvec4(0u));
  }
}
