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

#include "compiler/glsl/kernel.h"
#include "compiler/ir/legend.h"
#include "compiler/layout/resources.h"
#include "compiler/plan/codegen.h"
#include "compiler/snippet/snippet.h"
#include "compiler/snippet/time_function.h"

namespace dmvv::compiler {

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
  std::uint32_t seed_chains = 0, chained_sdfs = 0;         ///< searches that SDFs share, and the SDFs that share one
  std::uint32_t listed_objects = 0, sunk_objects = 0;  ///< called by loops; those of them by whether they answer alone
  std::vector<std::string> object_codegen;             ///< "ORANGE: specialised", ... with the reason where it was cut
  std::vector<std::string> tapes;                      ///< "SKIN: 8123 steps; ...": what became of each large snippet
};

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

/// The records in a program's buffers as text, one a line: for `--dump records` and goldens.
std::string records_text(const Program& program);

}  // namespace dmvv::compiler
