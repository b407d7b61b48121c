// Parts of triangles that are too large for one invocation: the square (x, y) of DMVV_PART_PX pixels.
struct TrianglePart {
  uint drawn;  // triangle | DMVV_DRAWN_*
  uint place;  // x | y << 16
};
layout(set = 0, binding = DMVV_RASTER_PARTS, std430) buffer Parts {
  uint part_count;  // more than DMVV_MOST_PARTS: not all could be kept
  uint pad0, pad1, pad2;
  TrianglePart parts[];
};
