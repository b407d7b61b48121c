#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster.h"
#include "shaders/records.h"
#include "shaders/cuts.glsl"
#include "shaders/surface.glsl"

// The section of the solid, where the stencil says that the cap's point of this pixel is inside it. Whether it is seen
// has been decided before (runtime/raster.cpp), so nothing is drawn here but what stays.
layout(early_fragment_tests) in;

layout(location = 0) out uvec4 surface_out;

const float never = 3.0e38;

// Depths [enter, leave] of a ray stay; nothing does if enter > leave. The planes are those that were crossed there.
struct Kept {
  float enter;
  float leave;
  uint enter_plane;
  uint leave_plane;
};

vec3 ray_direction(vec2 pixel) {
  precise vec3 direction = raster.ray.xyz + pixel.x * raster.ray_x.xyz + pixel.y * raster.ray_y.xyz;
  return direction;
}

Kept kept_part(vec3 direction) {
  Kept kept = Kept(-never, never, 0, 0);
  for (uint i = 0; i < cut_count(); ++i) {
    precise float along = dot(raster.cuts[i].plane.xyz, direction);
    float gap = raster.cuts[i].along.w;
    if (i < raster.front_count) {
      precise float t = along < 0.0 ? min(gap / along, never) : never;
      if (t > kept.enter) {
        kept.enter = t;
        kept.enter_plane = i;
      }
    } else if (along > 0.0) {
      precise float t = gap / along;
      if (t < kept.leave) {
        kept.leave = t;
        kept.leave_plane = i;
      }
    }
  }
  return kept;
}

void main() {
  vec3 direction = ray_direction(pixel_at(gl_FragCoord));
  Kept kept = kept_part(direction);
  bool from_outside = raster.front_count != 0;
  float t = from_outside ? kept.enter : kept.leave;
  vec4 plane = raster.cuts[from_outside ? kept.enter_plane : kept.leave_plane].plane;
  vec3 p = raster.eye.xyz + t * direction;
  p -= plane.xyz * (dot(plane.xyz, p) - plane.w);  // onto the plane: t is rounded
  bool stays = kept.enter <= kept.leave && t < never;
  surface_out = stays ? pack_surface(p, from_outside ? plane.xyz : -plane.xyz) : uvec4(0u);
}
