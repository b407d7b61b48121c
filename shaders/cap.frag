#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster.h"
#include "shaders/records.h"
#include "shaders/cuts.glsl"
#include "shaders/surface.glsl"

// The section of the solid, where the stencil says that the cap's point of this pixel is inside it.

layout(location = 0) out uvec4 surface_out;

void main() {
  vec3 direction = ray_direction(gl_FragCoord.xy);
  Kept kept = kept_part(direction);
  float t = cap_depth(kept);
  if (!(kept.enter <= kept.leave && t < never)) discard;
  bool outside = raster.eye_removed != 0;
  vec4 plane = raster.cuts[outside ? kept.enter_plane : kept.leave_plane].plane;
  vec3 p = raster.eye.xyz + t * direction;
  p -= plane.xyz * (dot(plane.xyz, p) - plane.w);  // onto the plane: t is rounded
  surface_out = pack_surface(p, outside ? plane.xyz : -plane.xyz);
  gl_FragDepth = min(raster.right.w / t, 1.0);
}
