// Kernel `points`: the scene at points of a buffer. Comes after the evaluation.

layout(local_size_x = DMVV_POINTS_GROUP_SIZE) in;
layout(set = 1, binding = DMVV_BIND_POINTS, std430) readonly buffer Points { vec4 points[]; };
layout(set = 1, binding = DMVV_BIND_ANSWERS, std430) writeonly buffer Answers { uint answers[]; };
layout(push_constant) uniform Params { PointsParams params; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= params.count) return;
  vec3 p = points[i].xyz;
  if (in_cube(p)) evaluate(p);
  vec4 rgba = hit_number != 0u ? color_of(hit_region, hit_p) : vec4(0.0);
  uint first = i * (DMVV_ANSWER_HEADER + 2 * DMVV_DEPTH);
  answers[first] = hit_unfinished ? DMVV_UNFINISHED : hit_number;
  answers[first + 1u] = hit_levels;
  answers[first + 2u] = floatBitsToUint(rgba.r);
  answers[first + 3u] = floatBitsToUint(rgba.g);
  answers[first + 4u] = floatBitsToUint(rgba.b);
  answers[first + 5u] = floatBitsToUint(rgba.a);
  for (uint k = 0u; k < 2u * DMVV_DEPTH; ++k) answers[first + DMVV_ANSWER_HEADER + k] = k < 2u * hit_levels ? hit_path[k] : 0u;
}
