#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
// Region 1 everywhere; its colour is the sine, cosine and tangent of x.

layout(local_size_x = DMVV_POINTS_GROUP_SIZE) in;
layout(set = 1, binding = DMVV_BIND_POINTS, std430) readonly buffer Points { vec4 points[]; };
layout(set = 1, binding = DMVV_BIND_ANSWERS, std430) writeonly buffer Answers { uint answers[]; };
layout(push_constant) uniform Params { PointsParams params; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= params.count) return;
  float x = points[i].x;
  uint first = i * (DMVV_ANSWER_HEADER + 2 * 2);
  answers[first] = 1;
  answers[first + 1] = 0;
  answers[first + 2] = floatBitsToUint(sin(x));
  answers[first + 3] = floatBitsToUint(cos(x));
  answers[first + 4] = floatBitsToUint(tan(x));
  answers[first + 5] = floatBitsToUint(1.0);
  for (uint k = 0; k < 4; ++k) answers[first + DMVV_ANSWER_HEADER + k] = 0;
}
