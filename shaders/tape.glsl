// Large snippets as tapes (compiler/layout/tapes.h): the cell of the point tells the side, or the instructions that decide it.
// Comes after shaders/evaluate.glsl and the generated tape_operation. Set by the generator: DMVV_TAPE_REGISTERS, a power
// of two, and DMVV_TAPE_THIRD where some operation has three operands.

// What a snippet is at q: its value, or where its side is known any value on that side.
float walk_tape(vec3 q, uint first_cell, float side, uint first_time_value) {
  vec3 c = clamp(floor((q + 1.0) * (0.5 * side)), vec3(0.0), vec3(side - 1.0));
  uint cell = tape_cell_at(first_cell + uint((c.z * side + c.y) * side + c.x));
  uint count = tape_at(cell).x;
  uint r[DMVV_TAPE_REGISTERS];
  r[0] = floatBitsToUint(q.x);
  r[1] = floatBitsToUint(q.y);
  r[2] = floatBitsToUint(q.z);
  uint value = floatBitsToUint(cell == DMVV_TAPE_NEGATIVE ? -3.0e38 : 3.0e38);
  uint walked = 0u;
  for (uint i = 0u; i < count; ++i) {
    ++walked;
    uvec2 instruction = tape_at(cell + 1u + i);
    uint x = instruction.x;
    r[DMVV_TAPE_CONSTANT] = instruction.y;
    uint a = r[(x >> 16u) & (DMVV_TAPE_REGISTERS - 1u)];
    uint b = r[(x >> 24u) & (DMVV_TAPE_REGISTERS - 1u)];
#ifdef DMVV_TAPE_THIRD
    uint third = r[instruction.y & (DMVV_TAPE_REGISTERS - 1u)];
#else
    uint third = 0u;
#endif
    value = tape_operation(x & 0xffu, a, b, third, instruction.y, first_time_value);
    r[(x >> 8u) & (DMVV_TAPE_REGISTERS - 1u)] = value;
  }
  hit_unfinished = hit_unfinished || walked != count;
  return uintBitsToFloat(value);
}
