#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster.h"
#include "shaders/records.h"
#include "shaders/cuts.glsl"
#include "shaders/surface.glsl"

// true: some of what is drawn may be cut away.
layout(constant_id = 1) const bool is_cut = false;
// true: no surface is drawn; fragments beyond the cap are counted by the stencil, leaving ones up, entering ones down.
layout(constant_id = 2) const bool counts = false;

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

// The cap is where the ray comes into what is left, or, if the eye is in it, goes out.
bool is_wanted(vec2 pixel, float inverse_depth) {
  if (!counts) return is_left(cut_count(), pixel, inverse_depth);
  bool from_outside = raster.front_count != 0;
  return is_left(from_outside ? raster.front_count : cut_count(), pixel, inverse_depth) == from_outside;
}

void main() {
  if (is_cut && !is_wanted(pixel_at(gl_FragCoord), gl_FragCoord.w)) discard;
  if (!counts) surface_out = pack_surface(snap(position, corner_position), gl_FrontFacing ? normal : -normal);
}
