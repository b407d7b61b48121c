// Parts of triangles that are too large for one invocation: the rectangle (x, y) of part_px pixels.
const uvec2 part_px = uvec2(DMVV_PART_COLUMNS, DMVV_PART_ROWS);

struct TrianglePart {
  uint drawn;  // triangle | DMVV_DRAWN_*
  uint place;  // x | y << 16
};
layout(set = 0, binding = DMVV_RASTER_PARTS, std430) buffer Parts {
  uint part_count;  // more than DMVV_MOST_PARTS: not all could be kept
  uint pad0, pad1, pad2;
  TrianglePart parts[];
};
