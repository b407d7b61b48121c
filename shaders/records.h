// The GPU records, defined once for C++ and GLSL. Included by compiler/ and runtime/, and by every shader.
//
// Layout: std430; every struct is made of 16-byte rows, so C++ and GLSL agree without padding rules.
#ifndef DMVV_SHADERS_RECORDS_H
#define DMVV_SHADERS_RECORDS_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
namespace dmvv::gpu {
using uint = std::uint32_t;
using vec4 = glm::vec4;
using uvec2 = glm::uvec2;
using uvec4 = glm::uvec4;
#endif

// ---- bindings of descriptor set 0: the scene (a program lists the ones it uses) ----
#define DMVV_BIND_GRID_ATLAS 0
#define DMVV_BIND_BITMAP_ATLAS 1
// From 2 on: compiler/layout/scene_buffers.def.

// ---- bindings of descriptor set 1 ----
// kernel `points`
#define DMVV_BIND_POINTS 0   // readonly vec4[count]: xyz root coordinates
#define DMVV_BIND_ANSWERS 1  // writeonly uint[count * (DMVV_ANSWER_HEADER + 2 * depth)]
// kernels over pixels, and `list` that comes before it
#define DMVV_BIND_SURFACE 0  // rgba32ui: the visible surface (shaders/surface.glsl)
#define DMVV_BIND_COLOR 1    // rgba32f out: straight alpha; 0 where there is nothing
#define DMVV_BIND_BYTES 2    // r32ui out, in place of it: 8 bits a channel, red lowest
#define DMVV_BIND_REGION 3   // r32ui out, if wanted: region number, 0 where empty
#define DMVV_BIND_LIST 4     // PixelListHeader, then a word an entry: x, and y in the upper half
// of a leader for its tile: the point and how far its answer holds, the answer's colour before shading and region number
#define DMVV_BIND_LEADER_PLACE 5   // rgba32f; w not positive: there is no such leader
#define DMVV_BIND_LEADER_COLOR 6   // rgba32f
#define DMVV_BIND_LEADER_REGION 7  // r32ui

// of programs in stages (compiler/plan/stage_plan.h)
#define DMVV_BIND_QUEUES 8     // QueueHeader, then the pixels of stages 1, 2, ..., with room for all of a tile each
#define DMVV_BIND_NEXT 9       // uint[]: of each pixel of the stage that ran last the stage it goes on to; 0: none

// of each entry of the lists, if `classify` made them: the cell to be told that it was evaluated, or the outcome to paint it with
#define DMVV_BIND_KNOWN 10     // uint[]
#define DMVV_BIND_FRAME 11     // FrameParams, uniform
#define DMVV_MOST_STAGES 16
// of pictures by rays (shaders/rays.h)
#define DMVV_BIND_RAYS 12       // RayParams, uniform
#define DMVV_BIND_RAY_TILES 13  // RayTilesHeader, then two words a tile
#define DMVV_BIND_RAY_NOTES 14  // r32ui: of each pixel DMVV_NOTE_*
#define DMVV_BIND_MEDIA 15      // vec4[]: of each pixel what is seen of media, premultiplied, and what they absorb

// ---- bindings of descriptor set 2 of `classify`: two trees of verdicts, one for ever, one for a span of time ----
#define DMVV_BIND_VERDICT_WORDS 0
#define DMVV_BIND_VERDICT_HITS 1  // uint[] like the words: pixels that were left to be evaluated
#define DMVV_BIND_OUTCOMES 2      // RegionRecord[], texture_from_object being texture_from_root
#define DMVV_BIND_BUSY_CELLS 3    // a count, then words of cells that were hit often
#define DMVV_MOST_BUSY_CELLS 65536u

// ---- specialisation constants of `pixels` and `classify` ----
#define DMVV_CONST_LISTED 0   // the pixels of the list, else all
#define DMVV_CONST_BYTES 1    // writes DMVV_BIND_BYTES, else DMVV_BIND_COLOR
#define DMVV_CONST_REGIONS 2  // writes DMVV_BIND_REGION

#define DMVV_POINTS_GROUP_SIZE 64  // local_size_x of `points`
#define DMVV_PIXELS_BLOCK 8        // pixels go in blocks of so many each way,
#define DMVV_PIXELS_GROUP_SIZE 64  // one block a group: local_size_x of `pixels`

// An answer of `points`: number, path length, rgba as float bits, then (region index, candidate) a level.
#define DMVV_ANSWER_HEADER 6
#define DMVV_UNFINISHED 0xffffffffu  // in place of an answer's number: the loop rounds of the device did not suffice

// The high bit of a node reference says that it names a region.
#define DMVV_REGION_BIT 0x80000000u

// What a cell of a snippet holds: a known side, or the place of a tape in `tapes`. The tapes at these places are empty.
#define DMVV_TAPE_POSITIVE 0u
#define DMVV_TAPE_NEGATIVE 1u

// Registers of a tape: p.x, p.y, p.z, the constant of the instruction, and others.
#define DMVV_TAPE_CONSTANT 3u
#define DMVV_TAPE_FIRST_FREE 4u
#define DMVV_FAMILY_BITS 10

#define DMVV_NO_FUNCTION 0xffffffffu
#define DMVV_NO_REGION 0xffffffffu
// What decides a boundary (shaders/reach.glsl): the source of an SDF, by its index; or one of these.
#define DMVV_AT_SOURCE 0x80000000u  // with it: the point is one of the source's own frame, else of its object's
#define DMVV_WALL 0x7ffffffeu       // of a box
#define DMVV_NO_DECIDER 0x7fffffffu
#define DMVV_MAX_CUTS 64

#define DMVV_KIND_SINGLE 0u
#define DMVV_KIND_SEEDED 1u
#define DMVV_KIND_TILED 2u

struct PointsParams {
  uint count;
  uint pad0, pad1, pad2;
};

// What all kernels over the pixels of a tile are told: a uniform block (DMVV_BIND_FRAME).
struct FrameParams {
  vec4 bounds_lo;  // xyz: positions are clamped to these bounds (they lie in them but for rounding)
  vec4 bounds_hi;
  vec4 light;      // xyz: unit vector from the surface to the light, root frame; w: 1 lit, 0 unlit
  uint width, height;
  uint hits_to_split;  // `classify`: hits after which a cell is to be split; 0: they are not counted
  uint keeps_still;    // `classify`: 1 if the images hold these pixels as of another time
  uint first_span_word;     // `classify`: of the tree for a span of time; 0: there is none
  uint first_span_outcome;
  uint counts_both;        // `classify`: 1 if half of the hits count for what may hold for ever
  uint paints_bitmaps;     // `classify`: 0: decided pixels of regions with bitmaps are evaluated all the same
  uint has_leaders;        // `list`, `classify`: 1 if leaders have a list of their own
  uint lists_all;          // `list`: 1 if pixels without a surface are listed too
  uint pad0, pad1;
};

// What one step of a frame is told beside that: a push constant.
struct StepParams {
  uint listed_kind;  // the list whose pixels are this kernel's
  uint stage;        // `distribute`: whose pixels go on
  uint is_cone;      // `rays`: 1: an invocation is a tile of pixels
};

// What `list` or `classify` counts, and indirect dispatches read. The lists of a kind lie one after the other, with room for all
// pixels, but for those to be painted: from the first one's end back.
#define DMVV_TO_EVALUATE 0u
#define DMVV_LEFT 1u       // evaluated after all: no leader's answer holds for them
#define DMVV_LEADERS_OF_TILES 2u  // evaluated first, and asked how far their answers hold
#define DMVV_TO_PAINT 3u
#define DMVV_LISTS_OF_PIXELS 4
#define DMVV_LEADER_TILE 4u  // pixels each way that have one leader
struct DispatchGroups {
  uint x, y, z;
};
struct PixelListHeader {
  DispatchGroups groups[DMVV_LISTS_OF_PIXELS];  // of the indirect dispatch over each list; 0, 1, 1 before `count_groups`
  uint counts[DMVV_LISTS_OF_PIXELS];    // pixels
  uint unfinished;                      // pixels for which the loop rounds of the device did not suffice
  uint pad0, pad1, pad2;
};
#define DMVV_NO_CELL 0xffffffffu
// What `distribute` counts, and indirect dispatches read.
struct QueueHeader {
  DispatchGroups groups[DMVV_MOST_STAGES];  // of each stage
  DispatchGroups runs[DMVV_MOST_STAGES];    // of `distribute` over each stage's pixels
  uint counts[DMVV_MOST_STAGES];            // pixels; of stage 0 none: its pixels are those of a list
};

// The highest bit of a surface texel's w: there is a surface.
#define DMVV_SURFACE_BIT 0x80000000u

// An affine map as three rows: q[i] = dot(row[i].xyz, p) + row[i].w.
struct AffineRows {
  vec4 x, y, z;
};

struct NodeRecord {
  uint sdf;
  uint positive;  // node, or region with DMVV_REGION_BIT
  uint negative;
  uint pad0;
};

// How far beyond a cell, in cells, its list counts where answers tell how far they hold (shaders/reach.glsl).
#define DMVV_CELL_MARGIN 0.25
// A uniform lookup grid: the cell of point p is floor(clamp((p - lo) * cells_per_unit, 0, size - 1)).
struct LookupRecord {
  vec4 lo;  // w unused
  vec4 cells_per_unit;
  uint size_x, size_y, size_z;
  uint first_cell;  // cells[first_cell + c] .. cells[first_cell + c + 1] is the range of cell c in lists
};

// A grid's place in the atlas, and the box of local points in which it is defined.
//   normalised atlas coordinate = q * atlas_scale + atlas_offset; in texels if the shader filters (DMVV_FILTER)
struct SdfRecord {
  vec4 box_lo;  // w: iso as stored, negative is f <= iso
  vec4 box_hi;
  vec4 atlas_scale;
  vec4 atlas_offset;
  vec4 flatness;         // xyz: one over the slopes of the bands around iso; w: what a value may be off (0: unknown)
  vec4 widths;           // xy: of the first two bands (compiler/proofs/steepness.h)
  LookupRecord lookup;   // of the seeds
  uint kind;             // DMVV_KIND_*
  uint first_placement;  // into placements
  uint function;         // the analytic source, or DMVV_NO_FUNCTION for a grid
  uint pad0;
};

struct RegionRecord {
  vec4 color;  // rgb and opacity
  AffineRows texture_from_object;
  vec4 slot_scale;   // bitmap: normalised atlas coordinate = u * slot_scale + slot_offset, u in [0,1); w: 1 if bitmap
  vec4 slot_offset;
  uint number;
  uint first_group;
  uint group_count;
  uint pad0;
};

// A run of candidates. With a box, the lookup lies in the box's frame, else in the object's.
struct GroupRecord {
  AffineRows box_from_object;
  LookupRecord lookup;
  uint has_box;
  uint first_placement;  // of the group's candidate 0
  uint first_number;     // of the group's candidate 0 within the region
  uint pad0;
};

// A seed or an embedded object.
struct PlacementRecord {
  AffineRows local_from_object;
  uint object;  // candidates only
  uint tiled;
  uint extent;     // candidates only: how far from the middle the object is not empty, 10 bits an axis; thesis: the number
                   // within the region, since there a list holds placements instead of their indices
  uint united;     // row of the object's parameters << DMVV_FAMILY_BITS | family, from 1 (compiler/glsl/families.h); else 0
};

// ---- verdict trees (compiler/proofs/verdict_tree.h) ----
// A tree of the standard cube: each cell is split into 4 x 4 x 4, a brick of words, x fastest; brick 0 splits the cube.
#define DMVV_VERDICT_LEVELS 8             // most splits: cells are 2 / 65536 wide then
#define DMVV_VERDICT_UNITS 65536u         // of the finest cells along an axis
#define DMVV_BRICK_WORDS 64u
// A cell's word: one of these bits, or none where it is open.
#define DMVV_VERDICT_DECIDED 0x80000000u  // | outcome
#define DMVV_VERDICT_INNER 0x40000000u    // | first word of the brick
#define DMVV_VERDICT_STILL 0x20000000u    // open, but no answer in it depends on the time
#define DMVV_VERDICT_FINAL 0x10000000u    // open, and not to be split
#define DMVV_VERDICT_BITMAP 0x08000000u   // decided, and the region has a bitmap
#define DMVV_VERDICT_VALUE 0x07ffffffu
#define DMVV_VERDICT_NOTED 0x80000000u    // of a cell's hits: it is to be split

#ifdef __cplusplus
static_assert(sizeof(PointsParams) == 16);
static_assert(sizeof(FrameParams) == 96);
static_assert(sizeof(StepParams) == 12);
static_assert(sizeof(PixelListHeader) == 80);
static_assert(sizeof(QueueHeader) == 28 * DMVV_MOST_STAGES);
static_assert(sizeof(AffineRows) == 48);
static_assert(sizeof(NodeRecord) == 16);
static_assert(sizeof(SdfRecord) == 160);
static_assert(sizeof(RegionRecord) == 112);
static_assert(sizeof(LookupRecord) == 48);
static_assert(sizeof(GroupRecord) == 112);
static_assert(sizeof(PlacementRecord) == 64);
}  // namespace dmvv::gpu
#endif

#endif
