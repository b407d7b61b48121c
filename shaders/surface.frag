#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster.h"
#include "shaders/cuts.glsl"

// true: no surface is drawn; fragments beyond the cap are counted by the stencil, leaving ones up, entering ones down.
layout(constant_id = 0) const bool count_beyond_cap = false;

layout(location = 0) in vec3 surface_position;
layout(location = 1) in vec3 surface_normal;
layout(location = 0) out vec4 position_out;
layout(location = 1) out vec4 normal_out;

void main() {
  precise float t = dot(raster.forward.xyz, surface_position - raster.eye.xyz);
  Kept kept = kept_part(ray_direction(gl_FragCoord.xy));
  if (count_beyond_cap) {
    float cap = cap_depth(kept);
    bool beyond = raster.eye_removed != 0 ? t >= cap : t > cap;
    if (!beyond) discard;
  } else if (t < kept.enter || t > kept.leave) {
    discard;
  }
  position_out = vec4(surface_position, 1.0);
  normal_out = vec4(normalize(gl_FrontFacing ? surface_normal : -surface_normal), 0.0);
}
