// The rays of a tile of the picture. Comes after shaders/rays.h and shaders/pixel_io.glsl.
layout(set = 1, binding = DMVV_BIND_RAYS, std140) uniform Rays { RayParams rays; };
layout(set = 1, binding = DMVV_BIND_RAY_NOTES, r32ui) uniform uimage2D ray_notes;
layout(set = 1, binding = DMVV_BIND_RAY_TILES, std430) buffer RayTiles {
  RayTilesHeader header;
  uint words[];
} tiles;

uint tile_count() { return rays.tiles_x * ((frame.height + DMVV_RAY_TILE - 1u) / DMVV_RAY_TILE); }
uvec2 tile_corner(uint tile) { return uvec2(tile % rays.tiles_x, tile / rays.tiles_x) * DMVV_RAY_TILE; }

// The tile of this group. A device of few threads gives each a row of groups that follow each other: neighbours take turns,
// so that all get their share of what takes long (measured: up to 1.6 times).
uint live_tile() {
  uint group = gl_WorkGroupID.x, half_of_them = (gl_NumWorkGroups.x + 1u) / 2u;
  uint turn = group < half_of_them ? 2u * group : 2u * (group - half_of_them) + 1u;
  return tiles.words[tile_count() + turn];
}

struct Ray {
  vec3 start, along;
};
Ray ray_through(vec2 pixel) {
  precise vec3 start = rays.start.xyz + pixel.x * rays.start_x.xyz + pixel.y * rays.start_y.xyz;
  precise vec3 along = rays.along.xyz + pixel.x * rays.along_x.xyz + pixel.y * rays.along_y.xyz;
  return Ray(start, along);
}

vec3 point_on(Ray ray, float s) {
  precise vec3 p = ray.start + s * ray.along;
  return p;
}
