// How kernels list pixels: an invocation looks at a run of a block's row, so that there is one atomic a block. All threads wait
// for the same word: one a pixel cost lavapipe as much as everything else in a frame of one colour.
// Comes after shaders/pixel_io.glsl; needs GL_KHR_shader_subgroup_arithmetic.

#define DMVV_RUN uint(DMVV_PIXELS_BLOCK)

uvec2 first_of_run() {
  uint i = gl_GlobalInvocationID.x;
  return block_corner(i / DMVV_RUN) + uvec2(0u, i % DMVV_RUN);
}

// Makes room for `count` entries of each invocation: the slot of its first one.
uint reserve(uint kind, uint count) {
  uint before = subgroupExclusiveAdd(count), sum = subgroupAdd(count), first = 0u;
  if (subgroupElect()) first = atomicAdd(list.header.counts[kind], sum);
  return subgroupBroadcastFirst(first) + before;
}

// Does the pixel lead its tile? One next to the middle, so that no other is far from it.
bool is_leader(uvec2 pixel) {
  return frame.has_leaders != 0u && all(equal(pixel % DMVV_LEADER_TILE, uvec2(DMVV_LEADER_TILE / 2u)));
}

void list_pixel(uvec2 pixel, uint entry) { list.entries[entry] = pixel.x | pixel.y << 16u; }
