#include "compiler/compile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "compiler/glsl/generate_glsl.h"
#include "compiler/glsl/kernel.h"
#include "compiler/grids/texels.h"
#include "compiler/ir/legend.h"
#include "compiler/layout/atlas.h"
#include "compiler/layout/flatten.h"
#include "compiler/layout/record_access.h"
#include "compiler/layout/resources.h"
#include "compiler/layout/tapes.h"
#include "compiler/passes/content.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/seed_chains.h"
#include "compiler/plan/codegen.h"
#include "compiler/proofs/judge.h"
#include "compiler/proofs/steepness.h"
#include "compiler/reference/reference.h"
#include "compiler/snippet/time_function.h"
#include "compiler/snippet/time_values.h"
#include "compiler/thesis/thesis.h"

namespace dmvv::compiler {

namespace {

constexpr std::uint32_t max_depth = 256;  // a walker's stack of 32-byte frames must fit private memory

bool enabled(const CompileOptions& options, std::string_view pass) {
  return std::find(options.disabled_passes.begin(), options.disabled_passes.end(), pass) ==
         options.disabled_passes.end();
}

/// Is there a kernel that tells how far answers hold?
bool tells_reach(const CompileOptions& options) {
  return options.many_frames && writes_code(options) && enabled(options, "reach");
}

bool in_stages(const CompileOptions& options) { return writes_code(options) && enabled(options, "stages"); }

GridStorage grid_storage(const Module& module, const CompileOptions& options) {
  return {options.atlas_format, options.filter, texel_scales(module, options.atlas_format, options.filter)};
}

template <class T>
void add_buffer(Program& program, const char* name, std::uint32_t binding, const std::vector<T>& records) {
  Buffer buffer{name, binding, std::vector<std::byte>(std::max<std::size_t>(records.size(), 1) * sizeof(T)),
                records.size()};
  if (!records.empty()) std::memcpy(buffer.bytes.data(), records.data(), records.size() * sizeof(T));
  program.statistics.buffer_bytes += buffer.bytes.size();
  program.buffers.push_back(std::move(buffer));
}

void add_buffers(Program& program, const Records& records, const Uses& uses) {
  if (uses.walker) add_buffer(program, "nodes", DMVV_BIND_NODES, records.nodes);
  if (uses.walker) add_buffer(program, "sdfs", DMVV_BIND_SDFS, records.sdfs);
  if (uses.walker || uses.region_colors) add_buffer(program, "regions", DMVV_BIND_REGIONS, records.regions);
  if (uses.walker) add_buffer(program, "groups", DMVV_BIND_GROUPS, records.groups);
  if (uses.placements) add_buffer(program, "placements", DMVV_BIND_PLACEMENTS, records.placements);
  if (uses.scalings) add_buffer(program, "scalings", DMVV_BIND_SCALINGS, records.scalings);
  if (uses.lists) add_buffer(program, "cells", DMVV_BIND_CELLS, records.cells);
  if (uses.lists) add_buffer(program, "lists", DMVV_BIND_LISTS, records.lists);
  if (uses.walker) add_buffer(program, "objects", DMVV_BIND_OBJECTS, records.objects);
}

/// Tells the placements of candidates where their objects' parameters are.
void name_united(Records& records, const Module& module, const std::map<Id<Object>, std::uint32_t>& united) {
  if (united.empty()) return;
  std::size_t group_record = 0;
  for (const Region& region : module.regions) {
    for (const CandidateGroup& group : region.groups) {
      const std::size_t first = records.groups[group_record++].first_placement;
      for (std::size_t i = 0; i < group.candidates.size(); ++i) {
        const auto known = united.find(group.candidates[i].object);
        if (known != united.end()) records.placements[first + i].united = known->second;
      }
    }
  }
}

/// Texels where generated code is to read them, the device has some, and no buffer has too many.
RecordAccess record_access(const Program& program, const CompileOptions& options) {
  const std::uint32_t most = options.max_texel_buffer_elements;
  if (most == 0 || !writes_code(options) || !enabled(options, "texel-records")) return RecordAccess::buffers;
  const bool fit = std::ranges::all_of(program.buffers, [&](const Buffer& buffer) {
    const BufferForm form = form_of(buffer.binding, RecordAccess::texels);
    return form == BufferForm::records || buffer.bytes.size() / bytes_per_texel(form) <= most;
  });
  return fit ? RecordAccess::texels : RecordAccess::buffers;
}

void write_kernels(Program& program, const Evaluation& evaluation, RecordAccess access) {
  for (Buffer& buffer : program.buffers) buffer.form = form_of(buffer.binding, access);
  for (const Kernel kernel : {Kernel::points, Kernel::pixels, Kernel::leaders}) {
    if (kernel == Kernel::leaders && !evaluation.uses.reach) continue;
    program.glsl[static_cast<std::size_t>(kernel)] = generate_glsl(evaluation, program.depth, kernel, access);
  }
  for (std::size_t i = 0; i < evaluation.stages.size(); ++i) {
    program.stages.push_back(
        {generate_stage_glsl(evaluation, program.depth, i, access), {}, evaluation.stages[i].has_next});
  }
}

/// Refuses functions that are no tapes, and so large that a driver would not end with them.
bool check_functions(const Module& module, const Tapes& tapes, const TapeOptions& options, Diagnostics& diagnostics) {
  std::vector<bool> seen(module.functions.size());
  for (const Sdf& sdf : module.sdfs) {
    const auto* id = std::get_if<Id<Function>>(&sdf.source);
    if (id == nullptr || seen[id->index]) continue;
    seen[id->index] = true;
    const std::size_t size = at(module.functions, *id).snippet.time_split().residual.instructions.size();
    const bool is_tape = !tapes.functions.empty() && tapes.functions[id->index].is_tape;
    if (is_tape || size <= options.most_code) continue;
    const std::string why = tapes.functions.empty() ? "tapes are off" : tapes.functions[id->index].note;
    diagnostics.report(
        Code::snippet_too_large, sdf.span,
        fmt::format("the SDF '{}' has {} instructions, and a driver can be asked to compile {} at most; it is no "
                    "tape ({}): divide it among several SDFs",
                    sdf.name, size, options.most_code, why));
  }
  return !diagnostics.has_errors();
}

bool check_buffers(const Program& program, std::uint64_t limit, Diagnostics& diagnostics) {
  for (const Buffer& buffer : program.buffers) {
    if (buffer.bytes.size() <= limit) continue;
    diagnostics.report(Code::buffer_too_large, {},
                       fmt::format("the scene's {} take {} bytes; the device allows {} a storage buffer", buffer.name,
                                   buffer.bytes.size(), limit));
  }
  return !diagnostics.has_errors();
}

void add_texture(Program& program, Atlas atlas) {
  program.statistics.texture_bytes += atlas.texture.texels.size();
  program.textures.push_back(std::move(atlas.texture));
}

void count(Statistics& statistics, const Module& module) {
  statistics.objects = static_cast<std::uint32_t>(module.objects.size());
  statistics.sdfs = static_cast<std::uint32_t>(module.sdfs.size());
  statistics.nodes = static_cast<std::uint32_t>(module.nodes.size());
  statistics.regions = static_cast<std::uint32_t>(module.regions.size());
  statistics.functions = static_cast<std::uint32_t>(module.functions.size());
  statistics.depth = module.depth;
  for (const Sdf& sdf : module.sdfs) {
    if (sdf.placement == voml::Placement::seeded)
      statistics.seeds += static_cast<std::uint32_t>(sdf.local_from_object.size());
  }
  for (const Region& region : module.regions) {
    for (const auto& group : region.groups)
      statistics.candidates += static_cast<std::uint32_t>(group.candidates.size());
  }
}

}  // namespace

bool writes_code(const CompileOptions& options) {
  return options.codegen == Codegen::specialised || options.codegen == Codegen::automatic;
}

IndexOptions index_options(const CompileOptions& options) {
  return {.use = enabled(options, "index"),
          .refine = writes_code(options) && enabled(options, "refine-index"),
          .widened = tells_reach(options) ? DMVV_CELL_MARGIN : 0.0};
}

std::vector<SeedChain> seed_chains(const Module& module, const CompileOptions& options) {
  return writes_code(options) && enabled(options, "chain-seeds") ? find_seed_chains(module) : std::vector<SeedChain>{};
}

const std::vector<PassInfo>& pass_names() {
  static const std::vector<PassInfo> passes{
      {"merge-assets", "identical grids, bitmaps and snippets are stored once"},
      {"prune-sides", "a decision between equal sides is left out"},
      {"drop-unreachable", "what no path from the root reaches is left out"},
      {"trim-cubes", "seeds and objects are asked only where their cubes are not surely empty"},
      {"index", "seeds and candidates are found through lookup grids"},
      {"refine-index", "an author's lookup grid has no fewer cells than the compiler would choose"},
      {"chain-seeds", "SDFs that ask for seeds of one shape after each other share one search"},
      {"fold-affine", "identities, translations and scalings are written as such"},
      {"unite-shapes", "objects of a group that are equal but for their numbers share one function"},
      {"sink-answers",
       "loops over candidates only find the one that answers; what it answers is evaluated behind them"},
      {"box-tests", "box tests that the standard cube already answers are left out"},
      {"stages", "pixels are evaluated by several kernels, each with the code of what its pixels came to"},
      {"tapes", "large snippets are tapes that one loop walks, instead of code"},
      {"shorten-tapes", "tapes are shortened for each cell of a grid by what intervals prove there"},
      {"texel-records", "records that a point finds are read from texels, on devices that load those faster"},
  };
  return passes;
}

void run_passes(Module& module, const CompileOptions& options) {
  if (options.codegen == Codegen::thesis) return;
  if (enabled(options, "merge-assets")) merge_assets(module);
  if (enabled(options, "prune-sides")) prune_sides(module);
  if (enabled(options, "drop-unreachable")) drop_unreachable(module);
  if (writes_code(options) && enabled(options, "trim-cubes")) trim_cubes(module, options.atlas_format, options.filter);
}

bool can_evaluate(const Module& module, Diagnostics& diagnostics) {
  if (module.depth > max_depth) {
    diagnostics.report(Code::embedding_too_deep, {},
                       fmt::format("objects are embedded {} levels deep; the limit is {}", module.depth, max_depth));
  }
  return !diagnostics.has_errors();
}

std::optional<Program> compile(Module module, const CompileOptions& options, Diagnostics& diagnostics) {
  if (!can_evaluate(module, diagnostics)) return std::nullopt;
  Program program;
  program.codegen = options.codegen;
  run_passes(module, options);
  program.regions = legend(module);
  program.depth = module.depth;

  const bool thesis = options.codegen == Codegen::thesis;
  auto grid_atlas = thesis
                        ? pack_thesis_atlas(module.grids, options.max_extent_3d, diagnostics)
                        : pack_atlas(module.grids, grid_storage(module, options), options.max_extent_3d, diagnostics);
  auto bitmap_atlas = pack_bitmaps(module.bitmaps, options.max_extent_3d, diagnostics);
  if (!grid_atlas || !bitmap_atlas) return std::nullopt;
  if (thesis && !fits_thesis(module, diagnostics)) return std::nullopt;
  TapeOptions tape_options = options.tapes;
  tape_options.shorten = enabled(options, "shorten-tapes");
  const Tapes tapes = !thesis && enabled(options, "tapes") ? make_tapes(module, tape_options) : Tapes{};
  if (!check_functions(module, tapes, tape_options, diagnostics)) return std::nullopt;
  const bool reaches = tells_reach(options);
  const auto steepness =
      reaches ? source_steepness(module, options.atlas_format, options.filter) : std::vector<snippet::Steepness>{};
  const GlslOptions glsl_options{options.codegen,
                                 options.inlined_line_budget,
                                 options.costs,
                                 enabled(options, "fold-affine"),
                                 enabled(options, "box-tests"),
                                 &tapes,
                                 writes_code(options) && enabled(options, "sink-answers"),
                                 writes_code(options) && enabled(options, "unite-shapes"),
                                 in_stages(options) ? std::optional(options.stages) : std::nullopt,
                                 options.many_frames,
                                 reaches ? &steepness : nullptr};
  const auto flattened = [&](std::vector<SeedChain> chains) {
    return thesis ? flatten_thesis(module, *grid_atlas, *bitmap_atlas)
                  : flatten(module, *grid_atlas, *bitmap_atlas, index_options(options), std::move(chains));
  };
  Records records = flattened(seed_chains(module, options));
  Evaluation evaluation = generate_evaluation(module, records, *grid_atlas, glsl_options);
  if (evaluation.uses.walker && !records.chains.empty()) {  // it knows no chains
    records = flattened({});
    evaluation = generate_evaluation(module, records, *grid_atlas, glsl_options);
  }
  name_united(records, module, evaluation.united);

  count(program.statistics, module);
  program.statistics.inlined_lines = evaluation.inlined_lines;
  program.statistics.stages = evaluation.stage_count;
  program.statistics.united_objects = static_cast<std::uint32_t>(evaluation.united.size());
  for (const auto& [object, is_sunk] : evaluation.listed) {
    ++program.statistics.listed_objects;
    program.statistics.sunk_objects += is_sunk;
  }
  program.statistics.united_functions = evaluation.united_functions;
  program.statistics.seed_chains = static_cast<std::uint32_t>(records.chains.size());
  for (const SeedChain& chain : records.chains)
    program.statistics.chained_sdfs += static_cast<std::uint32_t>(chain.size());
  program.statistics.object_codegen = std::move(evaluation.object_codegen);
  program.statistics.atlas_fill = grid_atlas->fill;
  program.time_functions = std::move(evaluation.time_functions);
  if (evaluation.uses.grid_atlas) add_texture(program, std::move(*grid_atlas));
  if (evaluation.uses.bitmap_atlas) add_texture(program, std::move(*bitmap_atlas));
  add_buffers(program, records, evaluation.uses);
  if (evaluation.uses.tapes) add_buffer(program, "tape_cells", DMVV_BIND_TAPE_CELLS, tapes.cells);
  if (evaluation.uses.tapes) add_buffer(program, "tapes", DMVV_BIND_TAPES, tapes.words);
  for (std::size_t i = 0; i < tapes.functions.size(); ++i) {
    const std::string& note = tapes.functions[i].note;
    if (!note.empty()) program.statistics.tapes.push_back(module.functions[i].name + ": " + note);
  }
  if (evaluation.uses.parameters) add_buffer(program, "parameters", DMVV_BIND_PARAMETERS, evaluation.parameters);
  if (evaluation.uses.time)
    add_buffer(program, "time_values", DMVV_BIND_TIME, time_values(program.time_functions, 0.0));
  write_kernels(program, evaluation, record_access(program, options));
  const std::string& pixels = program.glsl[static_cast<std::size_t>(Kernel::pixels)];
  program.statistics.glsl_lines = static_cast<std::uint32_t>(std::count(pixels.begin(), pixels.end(), '\n'));
  if (!check_buffers(program, options.max_storage_buffer, diagnostics)) return std::nullopt;
  if (options.many_frames && !thesis) {
    const Judge::Options stored{options.atlas_format, options.filter};
    program.judge = std::make_shared<Judge>(std::move(module), std::move(records), stored);
  }
  return program;
}

}  // namespace dmvv::compiler
