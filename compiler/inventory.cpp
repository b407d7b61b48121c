#include "compiler/inventory.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <set>

#include "compiler/glsl/generate_glsl.h"
#include "compiler/glsl/glsl_text.h"
#include "compiler/grids/storage.h"
#include "compiler/ir/placements.h"
#include "compiler/layout/flatten.h"
#include "compiler/layout/resources.h"
#include "compiler/layout/scene_buffers.h"
#include "compiler/passes/content.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/seed_chains.h"
#include "compiler/plan/codegen.h"

namespace dmvv::compiler {
namespace {

/// What an object's tree holds, each thing once, in the module's order.
struct Tree {
  std::set<std::uint32_t> decisions, sdfs, regions;
};

Tree tree_of(const Module& module, Id<Object> object) {
  Tree tree;
  std::set<std::uint32_t> seen;
  std::vector<Id<Node>> open{at(module.objects, object).root};
  while (!open.empty()) {
    const Id<Node> id = open.back();
    open.pop_back();
    if (!seen.insert(id.index).second) continue;
    const auto& content = at(module.nodes, id).content;
    if (const auto* decision = std::get_if<Decision>(&content)) {
      tree.decisions.insert(id.index);
      tree.sdfs.insert(decision->sdf.index);
      open.push_back(decision->positive);
      open.push_back(decision->negative);
    } else {
      tree.regions.insert(std::get<Id<Region>>(content).index);
    }
  }
  return tree;
}

std::vector<Tree> trees_of(const Module& module) {
  std::vector<Tree> trees;
  for (std::uint32_t i = 0; i < module.objects.size(); ++i) trees.push_back(tree_of(module, {i}));
  return trees;
}

// ---- what the passes found ----

std::size_t decisions_in(const Module& module) {
  std::size_t count = 0;
  for (const Tree& tree : trees_of(module)) count += tree.decisions.size();
  return count;
}

/// Things of each kind, by name.
using Counts = std::vector<std::pair<std::string_view, std::size_t>>;

Counts count(const Module& module) {
  return {{"decisions", decisions_in(module)},   {"objects", module.objects.size()}, {"SDFs", module.sdfs.size()},
          {"regions", module.regions.size()},    {"grids", module.grids.size()},     {"bitmaps", module.bitmaps.size()},
          {"functions", module.functions.size()}};
}

std::string difference(const Counts& before, const Counts& after) {
  std::string text;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].second == after[i].second) continue;
    text += fmt::format("{}{} {} -> {}", text.empty() ? "" : ", ", before[i].first, before[i].second, after[i].second);
  }
  return text.empty() ? "nothing to do" : text;
}

/// Lists that have a choice: with one entry there is nothing to find.
struct ListsFound {
  std::size_t lists = 0, entries = 0, cells = 0;
  std::uint32_t longest = 0;
  std::size_t wished = 0, refined = 0;  ///< lookup grids of a size that their authors chose; those that have more cells
};

/// The transforms that stand in the code as constants, and the boxes tested there.
std::string folded(const Module& module) {
  std::size_t all = 0, simple = 0;
  const auto add = [&](const Affine& affine) {
    ++all;
    simple += is_diagonal(affine) ? 1 : 0;
  };
  for (const Sdf& sdf : module.sdfs) {
    if (sdf.placement != voml::Placement::seeded) add(sdf.local_from_object.front());
  }
  for (const Region& region : module.regions) {
    if (region.kind == voml::RegionKind::bitmap) add(region.texture_from_object);
    for (const CandidateGroup& group : region.groups) {
      if (group.box_from_object) add(*group.box_from_object);
    }
  }
  return all == 0 ? "nothing to do" : fmt::format("{} of {} constant transforms turn nothing", simple, all);
}

std::string left_out_tests(const Module& module) {
  std::size_t all = 0, left_out = 0;
  for (const Sdf& sdf : module.sdfs) {
    if (sdf.placement != voml::Placement::single) continue;
    ++all;
    left_out += cube_maps_into(sdf.local_from_object.front(), local_box(sdf, module)) ? 1 : 0;
  }
  return all == 0 ? "nothing to do" : fmt::format("{} of {} box tests are left out", left_out, all);
}

/// What of the cubes that are asked is left, by volume.
std::string trimmed(const Module& module) {
  double left = 0.0;
  std::size_t cubes = 0;
  const auto add = [&](const LocalBox& content, std::size_t count) {
    const glm::dvec3 edges = 0.5 * (content.hi - content.lo);
    left += edges.x * edges.y * edges.z * static_cast<double>(count);
    cubes += count;
  };
  for (const Sdf& sdf : module.sdfs) {
    if (sdf.placement == voml::Placement::seeded) add(sdf.content, sdf.local_from_object.size());
  }
  for (const Region& region : module.regions) {
    for (const CandidateGroup& group : region.groups) {
      for (const Candidate& candidate : group.candidates) add(at(module.objects, candidate.object).content, 1);
    }
  }
  if (cubes == 0) return "nothing to do";
  return fmt::format("{:.0f} % of {} cubes are asked", 100.0 * left / static_cast<double>(cubes), cubes);
}

/// What there is to tell of a pass from: the module behind all of them, the program, and its lookup grids.
struct Found {
  const Module& module;
  const CompileOptions& options;
  const Program& program;
  const ListsFound& lists;

  const Sharing& shared() const { return program.statistics.shared; }
};

std::string tapes_found(const Found& found) {
  const std::vector<std::string>& tapes = found.program.statistics.tapes;
  return tapes.empty() ? "nothing to do" : fmt::format("{}", fmt::join(tapes, "; "));
}

std::string cells_found(const Found& found) {
  const Program& program = found.program;
  const auto cells = std::ranges::find(program.buffers, "tape_cells", &Buffer::name);
  const auto words = std::ranges::find(program.buffers, "tapes", &Buffer::name);
  if (cells == program.buffers.end()) return "nothing to do";
  return fmt::format("{} cells, {} bytes of tapes", cells->count, words->bytes.size());
}

std::string texels_found(const Found& found) {
  if (found.options.max_texel_buffer_elements == 0) return "";  // for what device is not known
  std::vector<std::string> names;
  for (const Buffer& buffer : found.program.buffers) {
    if (buffer.form != BufferForm::records) names.push_back(buffer.name);
  }
  return names.empty() ? "nothing to do" : fmt::format("{}", fmt::join(names, ", "));
}

std::string listed(const Found& found) {
  const ListsFound& lists = found.lists;
  if (lists.lists == 0) return "nothing to do";
  return fmt::format("{} list{} of {} entries in {} cells, {} at most in one", lists.lists, lists.lists == 1 ? "" : "s",
                     lists.entries, lists.cells, lists.longest);
}

std::string refined(const Found& found) {
  if (found.lists.wished == 0) return "nothing to do";
  return fmt::format("{} of {} lookup grids have more cells than their authors chose", found.lists.refined,
                     found.lists.wished);
}

std::string united_found(const Found& found) {
  const std::uint32_t functions = found.shared().united_functions;
  if (functions == 0) return "nothing to do";
  return fmt::format("{} objects share {} function{}", found.shared().united_objects, functions,
                     functions == 1 ? "" : "s");
}

std::string chained(const Found& found) {
  const std::uint32_t chains = found.shared().seed_chains;
  if (chains == 0) return "nothing to do";
  return fmt::format("{} SDFs share {} search{}", found.shared().chained_sdfs, chains, chains == 1 ? "" : "es");
}

std::string sunk(const Found& found) {
  const Sharing& shared = found.shared();
  if (shared.listed_objects == 0) return "nothing to do";
  return fmt::format("loops ask {} of {} objects only whether they answer", shared.sunk_objects, shared.listed_objects);
}

std::string stages_found(const Found& found) {
  const std::uint32_t stages = found.program.statistics.code.stages;
  return stages == 0 ? "nothing to do" : fmt::format("{} kernels for many frames, one for a single picture", stages);
}

/// How each pass is told of. Those that are not named here change the module: told by what there is less of.
struct Telling {
  std::string_view pass;
  std::string (*tell)(const Found&);
};
constexpr Telling tellings[] = {
    {"trim-cubes", [](const Found& found) { return writes_code(found.options) ? trimmed(found.module) : ""; }},
    {"index", listed},
    {"refine-index", refined},
    {"chain-seeds", chained},
    {"fold-affine", [](const Found& found) { return folded(found.module); }},
    {"unite-shapes", united_found},
    {"sink-answers", sunk},
    {"box-tests", [](const Found& found) { return left_out_tests(found.module); }},
    {"stages", stages_found},
    {"tapes", tapes_found},
    {"shorten-tapes", cells_found},
    {"texel-records", texels_found},
};

/// run_passes, with what each did to the module.
std::vector<PassEffect> run_and_tell(Module& module, const CompileOptions& options) {
  std::vector<PassEffect> effects;
  Counts before = count(module);
  for (const PassInfo& pass : pass_names()) {
    PassEffect& effect = effects.emplace_back(PassEffect{pass.name, ""});
    if (!is_enabled(options, pass.name)) effect.effect = "off";
    if (pass.run == nullptr || !is_enabled(options, pass.name)) continue;
    pass.run(module, options);
    const Counts after = count(module);
    effect.effect = difference(before, after);
    before = after;
  }
  return effects;
}

void tell(std::vector<PassEffect>& effects, const Found& found) {
  for (PassEffect& effect : effects) {
    const auto* const telling = std::ranges::find(tellings, effect.pass, &Telling::pass);
    if (telling != std::end(tellings) && effect.effect != "off") effect.effect = telling->tell(found);
  }
}

// ---- what each object costs ----

/// Bytes of the records of one object, by the buffer they stand in.
struct RecordBytes {
  std::uint64_t nodes = 0, sdfs = 0, regions = 0, groups = 0, placements = 0, scalings = 0, cells = 0, lists = 0,
                objects = 4;

  std::uint64_t in(std::string_view buffer) const {
    const std::pair<std::string_view, std::uint64_t> all[] = {
        {"nodes", nodes},       {"sdfs", sdfs},   {"regions", regions}, {"groups", groups},  {"placements", placements},
        {"scalings", scalings}, {"cells", cells}, {"lists", lists},     {"objects", objects}};
    const auto* found = std::ranges::find(all, buffer, &std::pair<std::string_view, std::uint64_t>::first);
    return found == std::end(all) ? 0 : found->second;
  }
};

class StockTaking {
 public:
  /// `chains`: SDFs that share a lookup.
  StockTaking(const Module& module, const CompileOptions& options, const std::vector<SeedChain>& chains)
      : module_(module), options_(options), chain_of_(module.sdfs.size(), nullptr) {
    for (const SeedChain& chain : chains) {
      for (const Id<Sdf> sdf : chain) chain_of_[sdf.index] = &chain;
    }
  }

  void run() {
    sdf_counted_.assign(module_.sdfs.size(), false);
    for (const Tree& tree : trees_of(module_)) count_object(tree);
  }

  std::vector<ObjectInventory> objects;
  std::vector<RecordBytes> records;
  ListsFound found;

 private:
  void count_object(const Tree& tree) {
    ObjectInventory& object = objects.emplace_back();
    RecordBytes& bytes = records.emplace_back();
    object.name = module_.objects[objects.size() - 1].name;
    object.decisions = static_cast<std::uint32_t>(tree.decisions.size());
    object.sdfs = static_cast<std::uint32_t>(tree.sdfs.size());
    object.regions = static_cast<std::uint32_t>(tree.regions.size());
    bytes.nodes = tree.decisions.size() * sizeof(gpu::NodeRecord);
    std::set<std::uint32_t> grids, bitmaps;
    for (const std::uint32_t i : tree.sdfs) {
      const Sdf& sdf = module_.sdfs[i];
      object.placements += static_cast<std::uint32_t>(sdf.local_from_object.size());
      if (const auto* grid = std::get_if<Id<voml::Grid>>(&sdf.source)) grids.insert(grid->index);
      const auto* function = std::get_if<Id<Function>>(&sdf.source);
      if (function && at(module_.functions, *function).snippet.uses_time()) object.moving_sdfs.push_back(sdf.name);
      if (sdf_counted_[i]) continue;  // two objects may use one; its records stand once
      sdf_counted_[i] = true;
      bytes.sdfs += sizeof(gpu::SdfRecord);
      bytes.placements += sdf.local_from_object.size() * sizeof(gpu::PlacementRecord);
      if (only_scale(sdf)) bytes.scalings += sdf.local_from_object.size() * sizeof(glm::vec4);
      if (sdf.placement != voml::Placement::seeded) continue;
      const SeedChain* const chain = chain_of_[i];
      if (chain == nullptr) {
        count_lookup(placed_boxes(sdf, module_), sdf.index_size, glm::dvec3(0.0), bytes);
      } else if (chain->front() == Id<Sdf>{i}) {
        count_lookup(placed_boxes(*chain, module_), index_size(*chain, module_), glm::dvec3(0.0), bytes);
      }
    }
    for (const std::uint32_t i : tree.regions) {
      const Region& region = module_.regions[i];
      if (region.kind == voml::RegionKind::bitmap) bitmaps.insert(region.bitmap.index);
      bytes.regions += sizeof(gpu::RegionRecord);
      for (const CandidateGroup& group : region.groups) {
        object.placements += static_cast<std::uint32_t>(group.candidates.size());
        bytes.groups += sizeof(gpu::GroupRecord);
        bytes.placements += group.candidates.size() * sizeof(gpu::PlacementRecord);
        count_lookup(placed_boxes(group, module_), group.index_size, lookup_frame_error(group), bytes);
      }
    }
    for (const std::uint32_t i : grids) add_texels(object, module_.grids[i].values.size(), options_.atlas_format);
    for (const std::uint32_t i : bitmaps) add_texels(object, module_.bitmaps[i].texels.size(), TexelFormat::rgba16f);
  }

  static void add_texels(ObjectInventory& object, std::size_t texels, TexelFormat format) {
    object.texels += texels;
    object.texel_bytes += texels * bytes_per_texel(format);
  }

  void count_lookup(const std::vector<PlacedBox>& boxes, const glm::uvec3& wish, const glm::dvec3& frame_error,
                    RecordBytes& bytes) {
    const IndexOptions index = index_options(options_);
    const Lookup lookup =
        build_lookup(boxes, index.use ? wish : glm::uvec3(1), frame_error, index.refine, index.widened);
    bytes.cells += lookup.cells.size() * sizeof(std::uint32_t);
    bytes.lists += lookup.lists.size() * sizeof(std::uint32_t);
    if (boxes.size() < 2) return;
    if (wish != glm::uvec3(0)) ++found.wished;
    if (wish != glm::uvec3(0) && lookup.cells.size() - 1 > std::size_t{wish.x} * wish.y * wish.z) ++found.refined;
    ++found.lists;
    found.entries += boxes.size();
    found.cells += lookup.cells.size() - 1;
    found.longest = std::max(found.longest, lookup.longest);
  }

  const Module& module_;
  const CompileOptions& options_;
  std::vector<const SeedChain*> chain_of_;  // of each SDF
  std::vector<bool> sdf_counted_;
};

}  // namespace

std::optional<Inventory> take_inventory(Module module, const CompileOptions& options, Diagnostics& diagnostics) {
  assert(options.codegen != Codegen::thesis);
  if (!can_evaluate(module, diagnostics)) return std::nullopt;
  Inventory result;
  result.passes = run_and_tell(module, options);
  auto program = compile(module, options, diagnostics);
  if (!program) return std::nullopt;
  result.program = std::move(*program);
  const bool shares = result.program.statistics.shared.seed_chains != 0;
  const std::vector<SeedChain> chains = shares ? seed_chains(module, options) : std::vector<SeedChain>{};
  StockTaking stock(module, options, chains);
  stock.run();
  tell(result.passes, {module, options, result.program, stock.found});
  result.objects = std::move(stock.objects);
  for (std::size_t i = 0; i < result.objects.size(); ++i) {
    ObjectInventory& object = result.objects[i];
    object.codegen = result.program.statistics.objects[i].form;
    for (const Buffer& buffer : result.program.buffers) object.record_bytes += stock.records[i].in(buffer.name);
  }
  return result;
}

}  // namespace dmvv::compiler
