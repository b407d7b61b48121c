#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster.h"
#include "shaders/cuts.glsl"

// The section of the solid, where the stencil says that the cap's point of this pixel is inside it.

layout(location = 0) out vec4 position_out;
layout(location = 1) out vec4 normal_out;

void main() {
  vec3 direction = ray_direction(gl_FragCoord.xy);
  Kept kept = kept_part(direction);
  float t = cap_depth(kept);
  if (!(kept.enter <= kept.leave && t < never)) discard;
  bool outside = raster.eye_removed != 0;
  vec4 plane = raster.cuts[outside ? kept.enter_plane : kept.leave_plane].plane;
  vec3 p = raster.eye.xyz + t * direction;
  p -= plane.xyz * (dot(plane.xyz, p) - plane.w);  // onto the plane: t is rounded
  position_out = vec4(p, 1.0);
  normal_out = vec4(outside ? plane.xyz : -plane.xyz, 0.0);
  gl_FragDepth = min(raster.right.w / t, 1.0);
}
