#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
// Region 1 where a distance texture says inside, region 2 elsewhere on the surface. The colour is what the scene's
// buffer asks for: the position, the normal, the light, or a checker pattern.

layout(local_size_x = DMVV_PIXELS_GROUP_SIZE, local_size_y = DMVV_PIXELS_GROUP_SIZE) in;
layout(set = 0, binding = DMVV_BIND_GRID_ATLAS) uniform sampler3D distance;
layout(set = 0, binding = DMVV_BIND_NODES, std430) readonly buffer Scene { uvec4 what; };
layout(set = 1, binding = DMVV_BIND_POSITION, rgba32f) readonly uniform image2D position_image;
layout(set = 1, binding = DMVV_BIND_NORMAL, rgba16f) readonly uniform image2D normal_image;
layout(set = 1, binding = DMVV_BIND_COLOR, rgba32f) writeonly uniform image2D color_image;
layout(set = 1, binding = DMVV_BIND_REGION, r32ui) writeonly uniform uimage2D region_image;
layout(push_constant) uniform Params { PixelsParams params; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= params.width || pixel.y >= params.height) return;
  vec4 surface = imageLoad(position_image, pixel);
  vec4 color = vec4(0.0);
  uint region = 0;
  if (surface.w == 1.0) {
    vec3 p = clamp(surface.xyz, params.bounds_lo.xyz, params.bounds_hi.xyz);
    region = textureLod(distance, 0.5 * p + 0.5, 0.0).r <= 0.0 ? 1 : 2;
    float checker = mod(floor(4.0 * p.x) + floor(4.0 * p.y) + floor(4.0 * p.z), 2.0);
    vec3 normal = imageLoad(normal_image, pixel).xyz;
    if (what.x == 0) color = vec4(p, 1.0);
    if (what.x == 1) color = vec4(normal, 1.0);
    if (what.x == 2) color = params.light;
    vec3 paint = mix(vec3(0.9, 0.5, 0.2), vec3(0.3, 0.4, 0.8), checker) * (region == 1 ? 1.0 : 0.6);
    if (what.x == 3) color = vec4(paint, 1.0);
    if (what.x == 3 && params.light.w == 1.0) color.rgb *= 0.3 + 0.7 * max(dot(normal, params.light.xyz), 0.0);
    if (what.x == 4) region = DMVV_UNFINISHED;
  }
  imageStore(color_image, pixel, color);
  imageStore(region_image, pixel, uvec4(region));
}
