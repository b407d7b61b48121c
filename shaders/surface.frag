#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster.h"
#include "shaders/records.h"
#include "shaders/cuts.glsl"
#include "shaders/surface.glsl"

// true: no surface is drawn; fragments beyond the cap are counted by the stencil, leaving ones up, entering ones down.
layout(constant_id = 0) const bool count_beyond_cap = false;

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) flat in vec3 corner_position;
layout(location = 0) out uvec4 surface_out;

// Interpolation is off by some 2^-22. A coordinate that equals the triangle's corner's to that precision is taken to be
// the same: so the faces of axis-aligned boxes are flat to the bit, and features that end there do not speckle.
vec3 snap(vec3 p, vec3 corner) {
  float tolerance = 5e-7 * max(max(abs(corner.x), abs(corner.y)), abs(corner.z));
  return mix(p, corner, lessThanEqual(abs(p - corner), vec3(tolerance)));
}

void main() {
  precise float t = dot(raster.forward.xyz, position - raster.eye.xyz);
  Kept kept = kept_part(ray_direction(gl_FragCoord.xy));
  if (count_beyond_cap) {
    float cap = cap_depth(kept);
    bool beyond = raster.eye_removed != 0 ? t >= cap : t > cap;
    if (!beyond) discard;
  } else if (t < kept.enter || t > kept.leave) {
    discard;
  }
  surface_out = pack_surface(snap(position, corner_position), normalize(gl_FrontFacing ? normal : -normal));
}
