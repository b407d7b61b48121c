#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster.h"

layout(set = 0, binding = 0, std140) uniform Raster { RasterParams raster; };

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 position_out;
layout(location = 1) out vec3 normal_out;
layout(location = 2) flat out vec3 corner_position;  // of the triangle's first vertex

invariant gl_Position;

void main() {
  vec3 from_eye = position - raster.eye.xyz;
  // Reversed depth without a far plane: z/w = near / t.
  gl_Position = vec4(dot(raster.right.xyz, from_eye), dot(raster.down.xyz, from_eye), raster.right.w,
                     dot(raster.forward.xyz, from_eye));
  position_out = position;
  corner_position = position;
  normal_out = normal;
}
