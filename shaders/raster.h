// What the raster kernels are told, defined once for C++ and GLSL (std140: every member is made of 16-byte rows).
#ifndef DMVV_SHADERS_RASTER_H
#define DMVV_SHADERS_RASTER_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/vec4.hpp>

#include "shaders/records.h"
namespace dmvv::gpu {
#endif

// Bindings of their descriptor set.
#define DMVV_RASTER_PARAMS 0
#define DMVV_RASTER_VERTICES 1  // four words: a position's bits, and a normal as two 16-bit numbers (packSnorm2x16, octahedral)
#define DMVV_RASTER_INDICES 2   // a word: three vertices a triangle
#define DMVV_RASTER_RUNS 3
#define DMVV_RASTER_NEAREST 4   // of each pixel of the tile, two words: ~triangle, then the bits of 1 / depth; 0: none
#define DMVV_RASTER_SHELLS 5    // of each pixel: how many times more often the solid is left than entered beyond the cap
#define DMVV_RASTER_PARTS 6
#define DMVV_RASTER_SURFACE 7   // image (shaders/surface.glsl)
#define DMVV_RASTER_BINDINGS 8

// What triangles are drawn for, where that takes two steps (shaders/nearest.glsl): a push constant.
#define DMVV_STEP_DEPTHS 0u
#define DMVV_STEP_NUMBERS 1u

// Specialisation constants.
#define DMVV_RASTER_CUTS 0      // how many cuts there are, if the kernel is made for so many (up to 3); 0xffffffff: any number
#define DMVV_RASTER_COUNTS 1    // whether shells are counted, for caps

#define DMVV_RUN_TRIANGLES 128u         // at most, of a run; invocations of a group
#define DMVV_GROUPS_OF_PARTS 1024u      // dispatched, whatever the number of parts
#define DMVV_PART_COLUMNS 128u           // of a part of a triangle
#define DMVV_PART_ROWS 32u
#define DMVV_MOST_PARTS 0x100000u
#define DMVV_COLUMN_PX 8u               // pixels below each other that are resolved by an invocation
#define DMVV_WHOLE_TRIANGLE_PX 1024u     // triangles with so many pixels around them at most are not divided

// What becomes of a triangle: bits above its number.
#define DMVV_DRAWN_SEEN 0x80000000u     // it may be seen
#define DMVV_DRAWN_COUNTED 0x40000000u  // its fragments are shells
#define DMVV_DRAWN_CUT 0x20000000u      // each pixel is tested against the cuts; else they leave all of it, and all of it counts
#define DMVV_DRAWN_BACKS 0x10000000u    // its back is seen
#define DMVV_DRAWN_TRIANGLE 0x0fffffffu

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
  vec4 picture;         // width and height, pixels; zw unused
  uvec4 tile;           // where its corner lies in the picture, and its size, pixels
  uint cut_count;
  uint front_count;  // of the first cuts: they take the eye's side away. Unless it is 0, caps are seen from outside
  uint run_count;
  uint pad0;
  CutPlane cuts[DMVV_MAX_CUTS];
};

// Neighbouring triangles with which the same is done.
struct TriangleRun {
  uint first;  // triangle | DMVV_DRAWN_*
  uint count;
};

#ifdef __cplusplus
static_assert(sizeof(CutPlane) == 32);
static_assert(sizeof(RasterParams) == 10 * 16 + DMVV_MAX_CUTS * 32);
static_assert(sizeof(TriangleRun) == 8);
}  // namespace dmvv::gpu
#endif

#endif
