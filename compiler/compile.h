// Module -> Program: passes, flatten, pack_atlas, generate_glsl, to_spirv in their order.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "compiler/glsl/kernel.h"
#include "compiler/grids/storage.h"
#include "compiler/ir/module.h"
#include "compiler/layout/tape_options.h"
#include "compiler/passes/seed_chains.h"
#include "compiler/plan/codegen.h"
#include "compiler/plan/cost_model.h"
#include "compiler/plan/stage_options.h"
#include "compiler/program.h"
#include "compiler/spirv/code_cache.h"

namespace dmvv::compiler {

struct IndexOptions;  // flatten.h

struct CompileOptions {
  Codegen codegen = Codegen::automatic;
  DeviceCosts costs;                             ///< of the device that will run the program, for Codegen::automatic
  TexelFormat atlas_format = TexelFormat::r32f;  ///< of distance grids: r32f, r16f, snorm16 or snorm8; not for thesis
  Filter filter = Filter::hardware;              ///< of distance grids; not for thesis
  std::uint32_t max_extent_3d = 2048;            ///< of the device that will run the program
  std::uint64_t max_storage_buffer = 128u << 20;
  /// Texels that a storage texel buffer of the device may have, if generated code is to read its records there; a
  /// program with a larger buffer, and all with 0, read them from storage buffers.
  std::uint32_t max_texel_buffer_elements = 0;
  std::uint32_t inlined_line_budget = 4000;  ///< beyond it, specialised code hands objects over to the generic walker
  /// The program will draw many frames. `compile` then also makes the judge that proves verdicts, the kernel `leaders`
  /// and stages; it takes longer. Ignored for thesis; for table there are no stages.
  bool many_frames = false;
  StageOptions stages;
  TapeOptions tapes;                         ///< `shorten` is what the pass says
  std::vector<std::string> disabled_passes;  ///< names of pass_names()
};

/// The passes that can be switched off, in the order they run: name and one sentence.
struct PassInfo {
  std::string_view name;
  std::string_view what;
};
const std::vector<PassInfo>& pass_names();

/// Is the scene's own code generated at all? Else its records alone are (the thesis' way, and its lists as they are).
bool writes_code(const CompileOptions& options);

/// How such a program looks seeds and candidates up.
IndexOptions index_options(const CompileOptions& options);

/// The chains of SDFs that share a search: none if the pass chain-seeds is off, or nothing is written as code.
std::vector<SeedChain> seed_chains(const Module& module, const CompileOptions& options);

/// Refuses what this version cannot evaluate, on the CPU or the GPU.
/// Errors: E0304 embedding deeper than 256 levels.
bool can_evaluate(const Module& module, Diagnostics& diagnostics);

/// The module that `compile` generates code for: with the passes that are not disabled behind it. None for
/// Codegen::thesis.
void run_passes(Module& module, const CompileOptions& options);

/// Runs the passes and generates records, textures and GLSL; no SPIR-V yet.
/// Errors: those of can_evaluate; E0303 an atlas, E0302 a buffer exceeds the device's limits; E0305 for Codegen::thesis
/// one of its fixed buffers is too small; then the result is empty.
/// Cost: linear in the scene, except index building (cells) and atlas packing (grids squared).
std::optional<Program> compile(Module module, const CompileOptions& options, Diagnostics& diagnostics);

/// Compiles one kernel's GLSL to SPIR-V 1.5 for Vulkan 1.2 with glslang and checks it with spirv-val; with `pixels`
/// also `leaders`, if there is one; a kernel that is there in stages is compiled in those. `cache` is asked first, and
/// told of what compiled. Errors: text that does not compile or validate is a bug of the generator; the error carries
/// both logs.
Result<void> to_spirv(Program& program, Kernel kernel, const CodeCache& cache = {});

}  // namespace dmvv::compiler
