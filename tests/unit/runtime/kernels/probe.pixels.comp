#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
#include "shaders/surface.glsl"
#include "shaders/pixel_io.glsl"
// Region 1 where a distance texture says inside, region 2 elsewhere on the surface. The colour is what the scene's
// buffer asks for: the position, the normal, the light, or a checker pattern.

layout(set = 0, binding = DMVV_BIND_GRID_ATLAS) uniform sampler3D distance;
layout(set = 0, binding = 2, std430) readonly buffer Scene { uvec4 what; };

void main() {
  uvec2 pixel;
  if (!find_pixel(pixel)) return;
  uvec4 surface = imageLoad(surface_image, ivec2(pixel));
  vec4 color = vec4(0.0);
  uint region = 0;
  if (surface.w != 0) {
    vec3 p = clamp(surface_position(surface), frame.bounds_lo.xyz, frame.bounds_hi.xyz);
    region = textureLod(distance, 0.5 * p + 0.5, 0.0).r <= 0.0 ? 1 : 2;
    float checker = mod(floor(4.0 * p.x) + floor(4.0 * p.y) + floor(4.0 * p.z), 2.0);
    vec3 normal = surface_normal(surface);
    if (what.x == 0) color = vec4(p, 1.0);
    if (what.x == 1) color = vec4(normal, 1.0);
    if (what.x == 2) color = frame.light;
    vec3 paint = mix(vec3(0.9, 0.5, 0.2), vec3(0.3, 0.4, 0.8), checker) * (region == 1 ? 1.0 : 0.6);
    if (what.x == 3) color = vec4(paint, 1.0);
    if (what.x == 3 && frame.light.w == 1.0) color.rgb *= 0.3 + 0.7 * max(dot(normal, frame.light.xyz), 0.0);
  }
  store_pixel(pixel, color, region, what.x == 4 && surface.w != 0);
}
