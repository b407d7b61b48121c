#include "compiler/compile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>

#include "compiler/glsl/generate_glsl.h"
#include "compiler/glsl/kernel.h"
#include "compiler/grids/texels.h"
#include "compiler/ir/legend.h"
#include "compiler/ir/opacity.h"
#include "compiler/layout/atlas.h"
#include "compiler/layout/flatten.h"
#include "compiler/layout/resources.h"
#include "compiler/layout/scene_buffers.h"
#include "compiler/layout/tapes.h"
#include "compiler/passes/content.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/seed_chains.h"
#include "compiler/plan/codegen.h"
#include "compiler/proofs/judge.h"
#include "compiler/proofs/steepness.h"
#include "compiler/reference/reference.h"
#include "compiler/snippet/time_slot.h"
#include "compiler/thesis/thesis.h"

namespace dmvv::compiler {

namespace {

constexpr std::uint32_t max_depth = 256;  // a walker's stack of 32-byte frames must fit private memory

bool has_leaders(const CompileOptions& options) {
  return options.many_frames && writes_code(options) && is_enabled(options, "reach");
}
bool has_rays(const CompileOptions& options) { return options.rays && options.codegen != Codegen::thesis; }

/// Is there a kernel that tells how far answers hold?
bool tells_reach(const CompileOptions& options) { return has_leaders(options) || has_rays(options); }

bool has_kernel(const CompileOptions& options, const Uses& uses, const KernelSpec& kernel) {
  if (kernel.query.medium) return uses.media;
  if (kernel.source == Source::rays || kernel.source == Source::hits) return has_rays(options);
  return !kernel.query.radius || has_leaders(options);
}

GridStorage grid_storage(const Module& module, const CompileOptions& options) {
  return {options.atlas_format, options.filter, texel_scales(module, options.atlas_format, options.filter)};
}

/// What scene_buffers.def takes the contents of buffers from.
struct SceneContents {
  const Records& records;
  const Tapes& tapes;
  const Evaluation& evaluation;
};

template <class T>
void add_buffer(Program& program, const SceneBuffer& row, const std::vector<T>& elements) {
  assert(sizeof(T) == row.element_bytes);
  Buffer buffer{std::string(row.name), row.binding,
                std::vector<std::byte>(std::max<std::size_t>(elements.size(), 1) * sizeof(T)), elements.size()};
  if (!elements.empty()) std::memcpy(buffer.bytes.data(), elements.data(), elements.size() * sizeof(T));
  program.statistics.bytes.buffers += buffer.bytes.size();
  program.buffers.push_back(std::move(buffer));
}

void add_buffers(Program& program, const SceneContents& from) {
  const auto& [records, tapes, evaluation] = from;
  const Uses& uses = evaluation.uses;
  const std::vector<float> time_values = snippet::time_values(program.time_slots, 0.0);
#define DMVV_SCENE_BUFFER(name, number, element, texels, present, contents) \
  if (present) add_buffer(program, *find_scene_buffer(number), contents);
#include "compiler/layout/scene_buffers.def"
#undef DMVV_SCENE_BUFFER
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

/// Tells the walker how steep sources are, in the units in which values are stored.
void tell_steepness(Records& records, const Module& module, const Atlas& grids,
                    const std::vector<Steepness>& steepness) {
  for (std::size_t i = 0; i < records.sdfs.size(); ++i) {
    const auto* grid = std::get_if<Id<voml::Grid>>(&module.sdfs[i].source);
    const double scale = grid != nullptr ? grids.scales[grid->index] : 1.0;
    const double error = 2.0 * steepness[i].error / scale;  // both points that are compared are off
    const auto& [near, middle, far] = steepness[i].slopes;
    records.sdfs[i].flatness = {flatness(near / scale), flatness(middle / scale), flatness(far / scale),
                                static_cast<float>(std::min(error, 1e30))};
    records.sdfs[i].widths = {steepness[i].widths[0] / scale, steepness[i].widths[1] / scale, 0.0, 0.0};
  }
}

/// Texels where generated code is to read them, the device has some, and no buffer has too many.
RecordAccess record_access(const Program& program, const CompileOptions& options) {
  const std::uint32_t most = options.max_texel_buffer_elements;
  if (most == 0 || !writes_code(options) || !is_enabled(options, "texel-records")) return RecordAccess::buffers;
  const bool fit = std::ranges::all_of(program.buffers, [&](const Buffer& buffer) {
    const BufferForm form = find_scene_buffer(buffer.binding)->form(RecordAccess::texels);
    return form == BufferForm::records || buffer.bytes.size() / bytes_per_texel(form) <= most;
  });
  return fit ? RecordAccess::texels : RecordAccess::buffers;
}

std::vector<Shader> write_shaders(const Evaluation& evaluation, std::uint32_t depth, const KernelSpec& kernel,
                                  RecordAccess access) {
  std::vector<Shader> shaders;
  const bool is_staged = kernel.name == pixels_kernel.name && !evaluation.stages.empty();
  if (!is_staged) shaders.push_back({generate_glsl(evaluation, depth, kernel, access), {}});
  for (std::size_t i = 0; is_staged && i < evaluation.stages.size(); ++i) {
    shaders.push_back({generate_glsl(evaluation, depth, kernel, access, i), {}, evaluation.stages[i].has_next});
  }
  return shaders;
}

void write_kernels(Program& program, const Evaluation& evaluation, RecordAccess access, const CompileOptions& options) {
  for (Buffer& buffer : program.buffers) buffer.form = find_scene_buffer(buffer.binding)->form(access);
  for (const KernelSpec& kernel : kernel_specs) {
    if (!has_kernel(options, evaluation.uses, kernel)) continue;
    program.kernels.push_back({kernel, write_shaders(evaluation, program.depth, kernel, access)});
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
  program.statistics.bytes.textures += atlas.texture.texels.size();
  program.textures.push_back(std::move(atlas.texture));
}

SceneCounts count(const Module& module) {
  const auto size = [](const auto& things) { return static_cast<std::uint32_t>(things.size()); };
  SceneCounts counts{.objects = size(module.objects),
                     .functions = size(module.functions),
                     .sdfs = size(module.sdfs),
                     .nodes = size(module.nodes),
                     .regions = size(module.regions),
                     .depth = module.depth};
  for (const Sdf& sdf : module.sdfs) {
    if (sdf.placement == voml::Placement::seeded) counts.seeds += size(sdf.local_from_object);
  }
  for (const Region& region : module.regions) {
    for (const auto& group : region.groups) counts.candidates += size(group.candidates);
  }
  return counts;
}

CodeSize size_of(const Program& program, const Evaluation& evaluation) {
  CodeSize size{.inlined_lines = evaluation.inlined_lines, .stages = evaluation.stage_count};
  for (const Shader& shader : program.find_kernel(pixels_kernel.name)->shaders)
    size.glsl_lines += static_cast<std::uint32_t>(std::ranges::count(shader.glsl, '\n'));
  return size;
}

Sharing sharing_of(const Evaluation& evaluation, const Records& records) {
  Sharing shared{.united_objects = static_cast<std::uint32_t>(evaluation.united.size()),
                 .united_functions = evaluation.united_functions,
                 .seed_chains = static_cast<std::uint32_t>(records.chains.size())};
  for (const SeedChain& chain : records.chains) shared.chained_sdfs += static_cast<std::uint32_t>(chain.size());
  for (const auto& [object, is_sunk] : evaluation.listed) {
    ++shared.listed_objects;
    shared.sunk_objects += is_sunk;
  }
  return shared;
}

/// Tells what was found; `program` is whole but for it.
void add_statistics(Program& program, const Module& module, const SceneContents& from) {
  Statistics& statistics = program.statistics;
  statistics.scene = count(module);
  statistics.code = size_of(program, from.evaluation);
  statistics.shared = sharing_of(from.evaluation, from.records);
  for (std::size_t i = 0; i < module.objects.size(); ++i)
    statistics.objects.push_back({module.objects[i].name, from.evaluation.object_forms[i]});
  for (std::size_t i = 0; i < from.tapes.functions.size(); ++i) {
    const std::string& note = from.tapes.functions[i].note;
    if (!note.empty()) statistics.tapes.push_back(module.functions[i].name + ": " + note);
  }
}

void run_trim_cubes(Module& module, const CompileOptions& options) {
  if (writes_code(options)) trim_cubes(module, options.atlas_format, options.filter);
}

template <void (*pass)(Module&)>
void run_pass(Module& module, const CompileOptions&) {
  pass(module);
}

}  // namespace

bool is_enabled(const CompileOptions& options, std::string_view pass) {
  return std::ranges::find(options.disabled_passes, pass) == options.disabled_passes.end();
}

bool writes_code(const CompileOptions& options) {
  return options.codegen == Codegen::specialised || options.codegen == Codegen::automatic;
}

IndexOptions index_options(const CompileOptions& options) {
  return {.use = is_enabled(options, "index"),
          .refine = writes_code(options) && is_enabled(options, "refine-index"),
          .widened = tells_reach(options) ? DMVV_CELL_MARGIN : 0.0};
}

std::vector<SeedChain> seed_chains(const Module& module, const CompileOptions& options) {
  return writes_code(options) && is_enabled(options, "chain-seeds") ? find_seed_chains(module)
                                                                    : std::vector<SeedChain>{};
}

const std::vector<PassInfo>& pass_names() {
  static const std::vector<PassInfo> passes{
      {"merge-assets", "identical grids, bitmaps and snippets are stored once", run_pass<merge_assets>},
      {"prune-sides", "a decision between equal sides is left out", run_pass<prune_sides>},
      {"drop-unreachable", "what no path from the root reaches is left out", run_pass<drop_unreachable>},
      {"trim-cubes", "seeds and objects are asked only where their cubes are not surely empty", run_trim_cubes},
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
  for (const PassInfo& pass : pass_names()) {
    if (pass.run != nullptr && is_enabled(options, pass.name)) pass.run(module, options);
  }
}

bool can_evaluate(const Module& module, Diagnostics& diagnostics) {
  if (module.depth > max_depth) {
    diagnostics.report(Code::embedding_too_deep, {},
                       fmt::format("objects are embedded {} levels deep; the limit is {}", module.depth, max_depth));
  }
  return !diagnostics.has_errors();
}

namespace {

struct Atlases {
  Atlas grids, bitmaps;
};

std::optional<Atlases> pack_atlases(const Module& module, const CompileOptions& options, Diagnostics& diagnostics) {
  auto grids = options.codegen == Codegen::thesis
                   ? pack_thesis_atlas(module.grids, options.max_extent_3d, diagnostics)
                   : pack_atlas(module.grids, grid_storage(module, options), options.max_extent_3d, diagnostics);
  auto bitmaps = pack_bitmaps(module.bitmaps, options.max_extent_3d, diagnostics);
  if (!grids || !bitmaps) return std::nullopt;
  return Atlases{std::move(*grids), std::move(*bitmaps)};
}

/// Nothing if some function can be neither a tape nor code.
std::optional<Tapes> tapes_of(const Module& module, const CompileOptions& options, Diagnostics& diagnostics) {
  TapeOptions tape_options = options.tapes;
  tape_options.shorten = is_enabled(options, "shorten-tapes");
  const bool wants_tapes = options.codegen != Codegen::thesis && is_enabled(options, "tapes");
  Tapes tapes = wants_tapes ? make_tapes(module, tape_options) : Tapes{};
  if (!check_functions(module, tapes, tape_options, diagnostics)) return std::nullopt;
  return tapes;
}

struct Written {
  Records records;
  Evaluation evaluation;
};

Written write_evaluation(const Module& module, const Atlases& atlases, const Tapes& tapes,
                         const CompileOptions& options) {
  const bool has_code = writes_code(options);
  const auto steepness =
      tells_reach(options) ? source_steepness(module, options.atlas_format, options.filter) : std::vector<Steepness>{};
  const GlslOptions glsl_options{
      .codegen = options.codegen,
      .inlined_line_budget = options.inlined_line_budget,
      .costs = options.costs,
      .fold_affine = is_enabled(options, "fold-affine"),
      .box_tests = is_enabled(options, "box-tests"),
      .tapes = &tapes,
      .sink_answers = has_code && is_enabled(options, "sink-answers"),
      .unite_shapes = has_code && is_enabled(options, "unite-shapes"),
      .stages = has_code && is_enabled(options, "stages") ? std::optional(options.stages) : std::nullopt,
      .write_stages = options.many_frames,
      .steepness = tells_reach(options) ? &steepness : nullptr,
      .rays = has_rays(options),
      .media = has_rays(options) && has_media(module)};
  const auto write = [&](std::vector<SeedChain> chains) {
    Records records = options.codegen == Codegen::thesis
                          ? flatten_thesis(module, atlases.grids, atlases.bitmaps)
                          : flatten(module, atlases.grids, atlases.bitmaps, index_options(options), std::move(chains));
    Evaluation evaluation = generate_evaluation(module, records, atlases.grids, glsl_options);
    return Written{std::move(records), std::move(evaluation)};
  };
  Written written = write(seed_chains(module, options));
  // The walker knows no chains.
  if (written.evaluation.uses.walker && !written.records.chains.empty()) written = write({});
  name_united(written.records, module, written.evaluation.united);
  if (tells_reach(options)) tell_steepness(written.records, module, atlases.grids, steepness);
  return written;
}

}  // namespace

std::optional<Build> build(Module module, const CompileOptions& options, Diagnostics& diagnostics) {
  if (!can_evaluate(module, diagnostics)) return std::nullopt;
  run_passes(module, options);
  std::optional<Atlases> atlases = pack_atlases(module, options, diagnostics);
  if (!atlases) return std::nullopt;
  if (options.codegen == Codegen::thesis && !fits_thesis(module, diagnostics)) return std::nullopt;
  const std::optional<Tapes> tapes = tapes_of(module, options, diagnostics);
  if (!tapes) return std::nullopt;
  Written written = write_evaluation(module, *atlases, *tapes, options);

  Program program;
  program.codegen = options.codegen;
  program.regions = legend(module);
  program.depth = module.depth;
  const LocalBox& content = at(module.objects, module.root).content;
  program.content = {content.lo, content.hi};
  program.time_slots = std::move(written.evaluation.time_slots);
  program.statistics.bytes.atlas_fill = atlases->grids.fill;
  if (written.evaluation.uses.grid_atlas) add_texture(program, std::move(atlases->grids));
  if (written.evaluation.uses.bitmap_atlas) add_texture(program, std::move(atlases->bitmaps));
  const SceneContents contents{written.records, *tapes, written.evaluation};
  add_buffers(program, contents);
  write_kernels(program, written.evaluation, record_access(program, options), options);
  add_statistics(program, module, contents);
  if (!check_buffers(program, options.max_storage_buffer, diagnostics)) return std::nullopt;
  return Build{std::move(program), std::move(module), std::move(written.records)};
}

std::optional<Program> compile(Module module, const CompileOptions& options, Diagnostics& diagnostics) {
  auto made = build(std::move(module), options, diagnostics);
  if (!made) return std::nullopt;
  return std::move(made->program);
}

std::shared_ptr<const Judge> make_judge(Module module, Records records, const CompileOptions& options) {
  if (options.codegen == Codegen::thesis) return nullptr;
  return std::make_shared<Judge>(std::move(module), std::move(records),
                                 Judge::Options{options.atlas_format, options.filter});
}

}  // namespace dmvv::compiler
