// What a frame does, in order: a pure value that can be printed and tested. Nothing is run here.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <vector>

#include "runtime/frame/strategy.h"
#include "runtime/surface/clusters.h"
#include "shaders/records.h"

namespace dmvv::runtime {

/// What the steps of a frame read and write.
enum class Resource : std::uint8_t {
  surface,   ///< position and normal of each pixel
  tiles,     ///< where rays begin, tile by tile, and the tiles that are not proven empty
  notes,     ///< what is known of each pixel's ray
  media,     ///< what each pixel's ray sees of media
  pixels,    ///< colours and region numbers
  lists,     ///< pixels to be evaluated, to be painted, ...: entries and their counts
  known,     ///< what is proven of each listed pixel
  leaders,   ///< of each 4 x 4 pixels: a point, its answer, and how far that holds
  queues,    ///< pixels of the stages that follow
  verdicts,  ///< trees of cells
  hits,      ///< how often cells left a pixel to be evaluated
  faults,    ///< pixels for which the device ran out of loop rounds
  report,    ///< counts, in memory that the host reads
  home,      ///< pixels there
};
inline constexpr std::size_t resource_count = 14;

enum class Step : std::uint8_t {
  raster,        ///< the support mesh
  slice,         ///< a section's points, in place of it
  set_out,       ///< rays, in place of both: what they are told
  cones,         ///< how far all rays of a tile meet nothing; lists the tiles that are left
  trace,         ///< what each ray meets first
  media,         ///< what rays see of the media that they go through, and what they meet behind
  normals,       ///< which way that faces
  clear,         ///< pixels, lists, leaders and queues before they are written
  list,          ///< which pixels show a surface
  classify,      ///< likewise, and which of them have a proven answer
  count_lists,   ///< how many groups each list takes
  paint,         ///< pixels with a proven answer
  lead,          ///< leaders
  follow,        ///< pixels near enough to their leader; lists those that are not
  evaluate,      ///< pixels of a list, or all, by one kernel
  count_stages,  ///< how many groups each queue takes
  stage,         ///< pixels of a queue, by one stage's kernel
  distribute,    ///< pixels of a stage to the queues of later ones
  compose,       ///< media before what is behind them
  count_hits,    ///< cells that left pixels to be evaluated
  report,        ///< how many pixels were evaluated, and for which the loop rounds did not suffice
  bring_home,    ///< pixels that the host wants
};
inline constexpr std::size_t step_count = 22;

/// How steps use a resource. Additions go to different places or are atomic: any number of steps may add without
/// waiting.
struct StepUse {
  const char* name;
  std::vector<Resource> reads, adds, writes;
};
const StepUse& use_of(Step step);

inline constexpr std::uint32_t no_list = ~0u;

struct PlannedStep {
  Step step;
  std::uint32_t list = no_list;  ///< DMVV_TO_EVALUATE, ...: the list that it runs over, if it does
  std::uint32_t stage = 0;       ///< of `stage` and `distribute`
  friend bool operator==(const PlannedStep&, const PlannedStep&) = default;
};

struct TilePlan {
  Tile tile;
  bool keeps_still = false;        ///< the images hold these pixels as of another time: those that stand still stay
  std::vector<PlannedStep> steps;  ///< none: the tile is there already, where it is wanted
};

/// Whether any pixel of the tile is evaluated: what is kept may still be brought home.
bool is_evaluated(const TilePlan& tile);

struct FramePlan {
  glm::uvec2 size_px{0};
  Strategy strategy;
  std::vector<TilePlan> tiles;
};

/// What the images of a tile hold before the frame.
struct KeptTile {
  bool surface = false;     ///< the surface that is wanted
  bool picture = false;     ///< all that is wanted
  bool home = false;        ///< and it was brought home
  bool other_time = false;  ///< all that is wanted, but for the time
};

/// What a picture's surface is.
enum class SurfaceKind : std::uint8_t { mesh, slice, rays };

struct FrameRequest {
  glm::uvec2 size_px{0};  ///< what is rendered: the picture times the samples
  std::vector<Tile> tiles;
  std::vector<KeptTile> kept;  ///< of each tile
  SurfaceKind surface = SurfaceKind::mesh;
  bool wants_normals = true;  ///< of what rays meet
  bool has_media = false;     ///< rays go through some regions
  FramePasses passes;
  Strategy strategy;
  bool brings_home = true;         ///< else the picture stays on the device
  std::vector<bool> stages_go_on;  ///< of each stage, whether pixels go on from it; empty: one kernel
};

/// Whether the images hold all of the frame already, so that there is nothing to evaluate.
bool is_kept(const FrameRequest& request);

/// The plan of a frame. Cost: linear in tiles and stages.
FramePlan plan_frame(const FrameRequest& request);

/// For each step of a tile, whether it must wait for those before it: the steps' declared uses say so.
std::vector<bool> waits(std::span<const PlannedStep> steps);

/// The plan as lines of text: for goldens and for whoever asks what a frame does.
std::string to_text(const FramePlan& plan);

}  // namespace dmvv::runtime
