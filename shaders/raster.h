// What the raster shaders are told, defined once for C++ and GLSL (std140: every member is made of 16-byte rows).
#ifndef DMVV_SHADERS_RASTER_H
#define DMVV_SHADERS_RASTER_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/vec4.hpp>
namespace dmvv::gpu {
using uint = std::uint32_t;
using vec4 = glm::vec4;
#endif

#define DMVV_MAX_CUTS 64

// A cutting plane: n.x > d is taken away.
struct CutPlane {
  vec4 plane;  // xyz: unit normal n, w: d
  vec4 along;  // n.direction of the ray of pixel (x, y) is along.xyz . (x, y, 1);
               // w: d - n.eye, negative where the plane takes the eye's side away
};

// A perspective picture. A point x lies at depth t = forward.(x - eye); the ray of a pixel is eye + t * direction, with
// forward.direction = 1, so that t is the depth along every ray.
struct RasterParams {
  vec4 eye;
  vec4 forward;         // unit
  vec4 right;           // scaled: right.(x - eye) / t is -1..1 across the picture; w: near
  vec4 down;            // scaled likewise; w unused
  vec4 ray;             // direction through the corner (0, 0) of the picture
  vec4 ray_x;           // its change from pixel to pixel, to the right
  vec4 ray_y;           // and down
  uint tile_x, tile_y;  // where the target's corner lies in the picture, pixels
  uint cut_count;
  uint front_count;  // of the first cuts: they take the eye's side away. Unless it is 0, caps are seen from outside
  CutPlane cuts[DMVV_MAX_CUTS];
};

#ifdef __cplusplus
static_assert(sizeof(CutPlane) == 32);
static_assert(sizeof(RasterParams) == 8 * 16 + DMVV_MAX_CUTS * 32);
}  // namespace dmvv::gpu
#endif

#endif
