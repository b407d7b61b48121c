// What the compiler hands to the runtime: bytes, textures, SPIR-V and the table that binds them. Plain data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compiler/snippet/snippet.h"

namespace dmvv::compiler {

enum class Codegen : std::uint8_t {
  specialised,  ///< the scene is the program
  table,        ///< records and one generic loop, as the thesis does it
  thesis,       ///< table with the errors of the published implementation (spec/thesis.md): for comparisons only
  automatic,    ///< of specialised and table what the device's costs say, object by object
};

/// The entry points of a program; each is a compute shader of its own (interfaces: shaders/points.comp, pixels.comp).
enum class Kernel : std::uint8_t {
  points,  ///< points in a buffer -> region, path and colour of each
  pixels,  ///< surface positions in images -> colour and region of each pixel
  leaders,  ///< as pixels, and how far each answer holds; if made at all (CompileOptions::many_frames)
};
inline constexpr std::size_t kernel_count = 3;

/// Normalised formats hold value / scale, one scale a grid (compiler/grids/texels.h).
enum class TexelFormat : std::uint8_t {
  r32f,
  r16f,
  snorm16,
  snorm8,
  unorm8,   ///< of Codegen::thesis alone
  rgba16f,  ///< of bitmaps
};
std::size_t bytes_per_texel(TexelFormat format);

/// How a value between the samples of a distance grid is found.
enum class Filter : std::uint8_t {
  hardware,  ///< trilinear, by the texture unit and with its weights (some have only 8 bits of them)
  shader,    ///< trilinear, 8 fetches and float32 weights
  tricubic,  ///< Catmull-Rom, 64 fetches: keeps the samples, smooth where trilinear has edges
};

/// How shaders read the records that each point finds by an index of its own (shaders/access.glsl). The values are the
/// same. From a storage buffer lavapipe loads them point after point, a texel of a storage texel buffer for eight points
/// at once.
enum class RecordAccess : std::uint8_t { buffers, texels };

/// What a buffer is to shaders.
enum class BufferForm : std::uint8_t {
  records,   ///< a storage buffer
  r32ui,     ///< a storage texel buffer, a word a texel
  rg32ui,    ///< likewise, two words
  rgba32ui,  ///< likewise, four words
};
/// 0 for records.
std::size_t bytes_per_texel(BufferForm form);

/// A buffer of descriptor set 0.
struct Buffer {
  std::string name;
  std::uint32_t binding;
  std::vector<std::byte> bytes;  ///< never empty: one record of zeros where there is none
  std::size_t count = 0;         ///< records
  BufferForm form = BufferForm::records;
};

/// A 3D texture of descriptor set 0 (combined image sampler, linear, clamped to the edge, no mipmaps).
struct Texture {
  std::string name;
  std::uint32_t binding;
  glm::uvec3 extent;
  TexelFormat format;
  bool filtered = true;           ///< false: the shader fetches texels, the device need not filter the format
  std::vector<std::byte> texels;  ///< x fastest; extent.x * extent.y * extent.z * bytes_per_texel
};

/// Legend of one region.
struct RegionInfo {
  std::uint32_t number;  ///< what pictures store; 0 for a region that is empty
  std::string object;
  std::string region;
  std::string kind;  ///< "color", "bitmap", "empty"
  glm::dvec3 rgb;    ///< color only
  double opacity;
};

/// One level of the way from the root object to the region that answered.
struct PathStep {
  std::uint32_t region;     ///< index into Program::regions (and Module::regions)
  std::uint32_t candidate;  ///< the region's candidate that was entered; 0 in the last step
  friend bool operator==(const PathStep&, const PathStep&) = default;
};

/// What a scene is at one point.
struct PointAnswer {
  std::uint32_t number = 0;    ///< region number; 0: empty
  std::vector<PathStep> path;  ///< root first; without any step where empty
  glm::dvec4 rgba{0.0};        ///< straight alpha, sRGB as shown; 0 where empty
  bool finished = true;        ///< false: the device ran out of loop rounds, nothing else is valid
};

/// "ORANGE:R.INNER[0]/ORANGE_SECTION:R.PULP"; empty for an empty path.
std::string format_path(const std::vector<RegionInfo>& regions, const std::vector<PathStep>& path);

/// What compiling did and what the shader is expected to cost; printed by `--dump stats`.
struct Statistics {
  std::uint32_t objects = 0, functions = 0, sdfs = 0, nodes = 0, regions = 0, candidates = 0, seeds = 0;
  std::uint32_t depth = 0;
  std::uint64_t buffer_bytes = 0, texture_bytes = 0;
  double atlas_fill = 0.0;  ///< share of the grid atlas that holds samples or borders
  std::uint32_t glsl_lines = 0;
  std::uint32_t inlined_lines = 0;  ///< estimate of the kernel after inlining
  std::uint32_t stages = 0;         ///< of `pixels`, in programs that draw many frames; 0: it is one kernel
  std::uint32_t united_objects = 0, united_functions = 0;  ///< objects that share one, and how many they share
  std::uint32_t seed_chains = 0, chained_sdfs = 0;  ///< searches that SDFs share, and the SDFs that share one
  std::uint32_t listed_objects = 0, sunk_objects = 0;  ///< called by loops; those of them by whether they answer alone
  std::vector<std::string> object_codegen;  ///< "ORANGE: specialised", ... with the reason where it was cut
  std::vector<std::string> tapes;           ///< "SKIN: 8123 steps; ...": what became of each large snippet
};

/// A snippet's share of the buffer `time_values`: values [first, first + snippet.time_value_count()).
struct TimeFunction {
  snippet::Snippet snippet;
  std::size_t first;
};

/// The contents of the buffer at binding DMVV_BIND_TIME for a frame: whatever depends on time alone, computed in double
/// and rounded once (spec/time.md). Empty in a static scene. Cost: the time part of each snippet, once a frame.
std::vector<float> time_values(std::span<const TimeFunction> functions, double time_ms);

class Judge;

/// A part of the kernel `pixels` with a list of pixels of its own (compiler/plan/stage_plan.h).
struct Stage {
  std::string glsl;
  std::vector<std::uint32_t> spirv;  ///< empty if `pixels` was not asked for
  bool has_next;                     ///< its pixels may go on to later stages
};

struct Program {
  Codegen codegen = Codegen::automatic;
  std::vector<Buffer> buffers;
  std::vector<Texture> textures;
  std::string glsl[kernel_count];
  std::vector<std::uint32_t> spirv[kernel_count];  ///< empty for a kernel that was not asked for, or is there in stages
  std::vector<Stage> stages;                       ///< `pixels` in parts, if there are any: stage 0 takes all pixels
  std::vector<RegionInfo> regions;                 ///< every region of the module, in its order
  std::uint32_t depth = 1;                         ///< most steps a path can have
  std::vector<TimeFunction> time_functions;        ///< empty in a static scene: then there is no time in its shader
  std::shared_ptr<const Judge> judge;              ///< if asked for: proves what boxes hold (judge.h)
  Statistics statistics;

  const std::vector<std::uint32_t>& code(Kernel kernel) const { return spirv[static_cast<std::size_t>(kernel)]; }
};

}  // namespace dmvv::compiler
