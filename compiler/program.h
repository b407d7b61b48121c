// What the compiler hands to the runtime: bytes, textures, SPIR-V and the table that binds them. Plain data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/glsl/kernel.h"
#include "compiler/ir/legend.h"
#include "compiler/layout/resources.h"
#include "compiler/plan/codegen.h"
#include "compiler/snippet/time_slot.h"
#include "voml/assets/mesh.h"

namespace dmvv::compiler {

/// Which form an object got, and why where it is not the one that was asked for.
struct ObjectForm {
  std::string object;
  std::string form;  ///< "specialised"; "table, 31 ns a point expected in place of 90"; ...
};

/// What a module holds.
struct SceneCounts {
  std::uint32_t objects = 0, functions = 0, sdfs = 0, nodes = 0, regions = 0, candidates = 0, seeds = 0, depth = 0;
};

/// What a program takes on a device.
struct ProgramBytes {
  std::uint64_t buffers = 0, textures = 0;
  double atlas_fill = 0.0;  ///< share of the grid atlas that holds samples or borders
};

/// What was written as code.
struct CodeSize {
  std::uint32_t glsl_lines = 0;     ///< of the kernel `pixels`, all its stages
  std::uint32_t inlined_lines = 0;  ///< estimate of the kernel after inlining
  std::uint32_t stages = 0;         ///< of `pixels`, in programs that draw many frames; 0: it is one shader
};

/// What several objects or SDFs have in common.
struct Sharing {
  std::uint32_t united_objects = 0, united_functions = 0;  ///< objects that share one, and how many they share
  std::uint32_t seed_chains = 0, chained_sdfs = 0;         ///< searches that SDFs share, and the SDFs that share one
  std::uint32_t listed_objects = 0, sunk_objects = 0;  ///< called by loops; those of them by whether they answer alone
};

/// What compiling did and what the shader is expected to cost; printed by `--dump stats`.
struct Statistics {
  SceneCounts scene;
  ProgramBytes bytes;
  CodeSize code;
  Sharing shared;
  std::vector<ObjectForm> objects;  ///< in the module's order
  std::vector<std::string> tapes;   ///< "SKIN: 8123 steps; ...": what became of each large snippet
};

/// One compute shader.
struct Shader {
  std::string glsl;
  std::vector<std::uint32_t> spirv;  ///< empty until to_spirv
  bool has_next = false;             ///< of a stage: its pixels may go on to later stages
};

/// A kernel is one shader, or stages that run after each other: stage 0 takes all pixels, each of the others those that
/// were sent to it (compiler/plan/stage_plan.h).
struct Kernel {
  KernelSpec spec;
  std::vector<Shader> shaders;

  bool is_staged() const { return shaders.size() > 1; }
};

/// A scene as a device runs it. Plain data: program_file.h saves and loads it.
struct Program {
  Codegen codegen = Codegen::automatic;
  std::vector<Buffer> buffers;
  std::vector<Texture> textures;
  std::vector<Kernel> kernels;
  std::vector<RegionInfo> regions;                          ///< every region of the module, in its order
  std::uint32_t depth = 1;                                  ///< most steps a path can have
  voml::Bounds content{glm::dvec3(-1.0), glm::dvec3(1.0)};  ///< at no time is anything beyond; root coordinates
  std::vector<snippet::TimeSlot> time_slots;                ///< the buffer `time_values`; empty in a static scene
  Statistics statistics;

  /// The kernel of that name; null if the program has none.
  const Kernel* find_kernel(std::string_view name) const;
  /// The first shader of a kernel that is there.
  const Shader& shader(std::string_view kernel) const { return find_kernel(kernel)->shaders.front(); }
};

/// The records in a program's buffers as text, one a line: for `--dump records` and goldens.
std::string records_text(const Program& program);

}  // namespace dmvv::compiler
