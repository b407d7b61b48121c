// Module -> Program: passes, flatten, pack_atlas, generate_glsl, to_spirv in their order.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "compiler/glsl/kernel.h"
#include "compiler/grids/storage.h"
#include "compiler/ir/module.h"
#include "compiler/layout/flatten.h"
#include "compiler/layout/tape_options.h"
#include "compiler/passes/seed_chains.h"
#include "compiler/plan/codegen.h"
#include "compiler/plan/cost_model.h"
#include "compiler/plan/stage_options.h"
#include "compiler/program.h"
#include "compiler/spirv/code_cache.h"

namespace dmvv::compiler {

class Judge;  // proofs/judge.h

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
  /// The program will draw many frames. It then also has the kernel `leaders`, and `pixels` in stages; it takes longer
  /// to compile. Only code that is written for the scene has them: ignored for thesis and table.
  bool many_frames = false;
  /// The program will draw pictures by rays: it then has the kernels `rays` and `normals`. Ignored for thesis.
  bool rays = false;
  StageOptions stages;
  TapeOptions tapes;                         ///< `shorten` is what the pass says
  std::vector<std::string> disabled_passes;  ///< names of pass_names()
};

/// A pass that can be switched off.
struct PassInfo {
  std::string_view name;
  std::string_view what;  ///< one sentence
  /// Changes the module; null for a pass that later stages carry out.
  void (*run)(Module&, const CompileOptions&) = nullptr;
};
/// All passes, in the order they run.
const std::vector<PassInfo>& pass_names();

/// Is this pass not switched off?
bool is_enabled(const CompileOptions& options, std::string_view pass);

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

/// A program, and what it was made from: the module behind the passes, and its records.
struct Build {
  Program program;
  Module module;
  Records records;
};

/// Runs the passes and generates records, textures and GLSL; no SPIR-V yet.
/// Errors: those of can_evaluate; E0303 an atlas, E0302 a buffer exceeds the device's limits; E0305 for Codegen::thesis
/// one of its fixed buffers is too small; then the result is empty.
/// Cost: linear in the scene, except index building (cells) and atlas packing (grids squared).
std::optional<Build> build(Module module, const CompileOptions& options, Diagnostics& diagnostics);

/// As `build`, the program alone.
std::optional<Program> compile(Module module, const CompileOptions& options, Diagnostics& diagnostics);

/// What proves answers for the many frames that a program draws (proofs/judge.h), made beside the program from what
/// `build` left; null for Codegen::thesis, whose answers nothing proves.
std::shared_ptr<const Judge> make_judge(Module module, Records records, const CompileOptions& options);

/// Compiles the kernels that ask about points of this source (of rays: all that draw pictures by rays), shader by
/// shader, to SPIR-V 1.5 for Vulkan 1.2 with glslang, and checks it with spirv-val. `cache` is asked first, and told of
/// what compiled. Errors: text that does not compile or validate is a bug of the generator; the error carries both
/// logs.
Result<void> to_spirv(Program& program, Source source, const CodeCache& cache = {});

/// What spirv-val says of code for Vulkan 1.2: empty if it is valid.
std::string validate_spirv(std::span<const std::uint32_t> spirv);

}  // namespace dmvv::compiler
