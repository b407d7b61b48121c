#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
// Puts the media that rays went through before what they met behind. Colours are straight; those of media are
// premultiplied.

layout(local_size_x = DMVV_PIXELS_GROUP_SIZE) in;
layout(set = 1, binding = DMVV_BIND_COLOR, rgba32f) uniform image2D color_image;
layout(set = 1, binding = DMVV_BIND_MEDIA, std430) readonly buffer Media { vec4 media[]; };
layout(set = 1, binding = DMVV_BIND_FRAME, std140) uniform FrameBlock { FrameParams frame; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= frame.width * frame.height) return;
  vec4 before = media[i];
  if (before.a == 0.0) return;
  ivec2 pixel = ivec2(i % frame.width, i / frame.width);
  vec4 behind = imageLoad(color_image, pixel);
  float through = (1.0 - before.a) * behind.a, alpha = before.a + through;
  imageStore(color_image, pixel, vec4((before.rgb + through * behind.rgb) / alpha, alpha));
}
