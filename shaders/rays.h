// What kernels over rays are told, and what they tell each other, defined once for C++ and GLSL.
#ifndef DMVV_SHADERS_RAYS_H
#define DMVV_SHADERS_RAYS_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/vec4.hpp>

#include "shaders/records.h"
namespace dmvv::gpu {
#endif

#define DMVV_RAY_TILE 8u           // pixels each way that set out together: a group of `rays`
#define DMVV_MOST_RAY_STEPS 2048   // of one ray, and of one tile's cone
#define DMVV_LEAST_STEP 0.0625     // of a ray where nothing is proven, in widths of its pixel
#define DMVV_PATIENCE 160          // steps after which the least step grows,
#define DMVV_IMPATIENCE 1.125      // by so much each time, up to a pixel's width

// What is known of a pixel's ray, bit by bit (DMVV_BIND_RAY_NOTES).
#define DMVV_NOTE_NORMAL 1u      // its surface wants the normal of what it met
#define DMVV_NOTE_DOUBT 2u       // on some piece of it nothing is proven: something thin may have been missed

// The rays of a tile of the picture (std140: every member is made of 16-byte rows). The ray of pixel (x, y) is
//   start + x start_x + y start_y + s (along + x along_x + y along_y),
// s being depth beyond the plane on which it starts, which stands near the scene: so points are as exact as the scene is.
struct RayParams {
  vec4 start, start_x, start_y;
  vec4 along, along_x, along_y;
  vec4 lo, hi;        // of the box beyond which nothing is seen
  float depth;        // of that plane: the eye is at s = -depth
  float pixel;        // width of a pixel at depth 1
  uint cut_count;
  uint tiles_x;       // DMVV_RAY_TILEs in a row
  vec4 cuts[DMVV_MAX_CUTS];  // n.x > w is taken away; n is a unit vector
};

// What cones found (DMVV_BIND_RAY_TILES): this, then of each tile where its rays begin (the bits of s), then the tiles
// that are not proven empty.
struct RayTilesHeader {
  DispatchGroups live;  // the dispatch over those
  uint doubtful;        // rays
  uint unfinished;      // rays
  uint begun_within;    // rays that begin within something opaque
  uint pad0, pad1;
};

#ifdef __cplusplus
static_assert(sizeof(RayParams) == 9 * 16 + DMVV_MAX_CUTS * 16);
static_assert(sizeof(RayTilesHeader) == 32);
}  // namespace dmvv::gpu
#endif

#endif
