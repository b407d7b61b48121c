#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/records.h"
// Region 1 within a sphere around the origin, with one step of path; region 2 up to the unit radius, with two; empty
// beyond. Region DMVV_UNFINISHED where x > 50.

layout(local_size_x = DMVV_POINTS_GROUP_SIZE) in;
layout(set = 0, binding = 2, std430) readonly buffer Scene { vec4 radius; };
layout(set = 1, binding = DMVV_BIND_POINTS, std430) readonly buffer Points { vec4 points[]; };
layout(set = 1, binding = DMVV_BIND_ANSWERS, std430) writeonly buffer Answers { uint answers[]; };
layout(push_constant) uniform Params { PointsParams params; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= params.count) return;
  vec3 p = points[i].xyz;
  uint number = length(p) <= radius.x ? 1 : length(p) <= 1.0 ? 2 : 0;
  uint first = i * (DMVV_ANSWER_HEADER + 2 * 2);
  answers[first] = p.x > 50.0 ? DMVV_UNFINISHED : number;
  answers[first + 1] = number;  // levels: as many as the number says
  answers[first + 2] = floatBitsToUint(p.x);
  answers[first + 3] = floatBitsToUint(p.y);
  answers[first + 4] = floatBitsToUint(p.z);
  answers[first + 5] = floatBitsToUint(1.0);
  for (uint k = 0; k < 4; ++k) answers[first + DMVV_ANSWER_HEADER + k] = 10 * number + k;
}
