// VOML text -> Scene: read the documents, resolve the names, open the files that are needed.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <new>

#include "base/text.h"
#include "voml/draft.h"
#include "voml/scene_graph.h"

namespace dmvv::voml {
namespace {

/// Opens what the flagged SDFs and regions refer to, each file once.
void load_assets(Draft& draft, const Needed& needed, const ReadFile& files, Diagnostics& diagnostics) {
  Scene& scene = draft.scene;
  std::vector<bool> grids(scene.grids.size()), bitmaps(scene.bitmaps.size()), seed_lists(scene.seed_lists.size());
  const auto load = [&](auto id, std::vector<bool>& loaded) {
    if (!id.valid() || loaded[id.index]) return;
    loaded[id.index] = true;
    draft.assets.load(scene, id, files, diagnostics);
  };
  for (std::size_t i = 0; i < scene.sdfs.size(); ++i) {
    if (!needed.sdfs[i]) continue;
    if (const auto* grid = std::get_if<Id<Grid>>(&scene.sdfs[i].source)) load(*grid, grids);
    load(scene.sdfs[i].seeds, seed_lists);
  }
  for (std::size_t i = 0; i < scene.regions.size(); ++i) {
    if (!needed.regions[i]) continue;
    load(scene.regions[i].bitmap, bitmaps);
    for (const EmbeddingGroup& group : scene.regions[i].groups) {
      for (const Embedded& embedded : group.embedded) load(embedded.seeds, seed_lists);
    }
  }
}

/// The largest and, of scales, smallest magnitudes in a seed list.
struct SeedExtremes {
  glm::dvec3 position{0.0};
  glm::dvec3 rotate{0.0};
  glm::dvec3 scale_most{0.0};
  glm::dvec3 scale_least{std::numeric_limits<double>::infinity()};
};

SeedExtremes extremes_of(const SeedList& list) {
  SeedExtremes result;
  for (const Seed& seed : list.seeds) {
    for (int i = 0; i < 3; ++i) {
      result.position[i] = std::max(result.position[i], std::abs(seed.position[i]));
      result.rotate[i] = std::max(result.rotate[i], std::abs(seed.rotate_deg[i]));
      result.scale_most[i] = std::max(result.scale_most[i], std::abs(seed.scale[i]));
      result.scale_least[i] = std::min(result.scale_least[i], std::abs(seed.scale[i]));
    }
  }
  return result;
}

/// Seeds and the transform they are combined with may each be fine, and their combination beyond float32.
class CombinationCheck {
 public:
  CombinationCheck(const Scene& scene, Diagnostics& diagnostics) : scene_(scene), diagnostics_(diagnostics) {
    for (const SeedList& list : scene.seed_lists) extremes_.push_back(extremes_of(list));
  }

  void run() {
    for (const Sdf& sdf : scene_.sdfs) check(sdf.seeds, sdf.transform, sdf.span);
    for (const Region& region : scene_.regions) {
      for (const EmbeddingGroup& group : region.groups) {
        for (const Embedded& embedded : group.embedded) check(embedded.seeds, embedded.transform, embedded.span);
      }
    }
  }

 private:
  void check(Id<SeedList> list, const Transform& transform, Span span) {
    if (!list.valid() || at(scene_.seed_lists, list).seeds.empty()) return;
    constexpr double largest = std::numeric_limits<float>::max();
    const SeedExtremes& seeds = at(extremes_, Id<SeedExtremes>{list.index});
    const std::string& path = at(scene_.seed_lists, list).path;
    for (int i = 0; i < 3; ++i) {
      const double position = 2.0 * seeds.position[i] + std::abs(transform.translate[i]);
      const double angle = seeds.rotate[i] + std::abs(transform.rotate_deg[i]);
      const double scale = std::abs(transform.scale[i]);
      if (!usable_scale(scale)) return;  // reported where it stands
      if (position > largest || angle > largest || seeds.scale_most[i] * scale > largest) {
        diagnostics_.report(
            Code::not_finite, span,
            fmt::format("the seeds of {} with the transform of this element go beyond float32", in_quotes(path)));
        return;
      }
      if (!usable_scale(seeds.scale_least[i] * scale)) {
        diagnostics_.report(
            Code::zero_scale, span,
            fmt::format("the scales of the seeds of {} times the scale of this element come to zero", in_quotes(path)));
        return;
      }
    }
  }

  const Scene& scene_;
  Diagnostics& diagnostics_;
  std::vector<SeedExtremes> extremes_;
};

}  // namespace

std::optional<Scene> read_scene(const std::string& path, const ReadFile& files, const ReadOptions& options,
                                Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  try {
    Draft draft;
    draft.scene.path = path;
    read_documents(path, files, draft, diagnostics);
    connect_functions(draft, diagnostics);
    resolve_names(draft, options, diagnostics);
    Needed needed = needed_by(draft.scene, draft.scene.root);
    if (options.load_everything) {
      needed.sdfs.assign(draft.scene.sdfs.size(), true);
      needed.regions.assign(draft.scene.regions.size(), true);
    }
    load_assets(draft, needed, files, diagnostics);
    CombinationCheck(draft.scene, diagnostics).run();
    if (diagnostics.error_count() != errors_before) return std::nullopt;
    return std::move(draft.scene);
  } catch (const std::bad_alloc&) {
    diagnostics.report(Code::cannot_read_file, Span{},
                       fmt::format("there is not enough memory to read {}", in_quotes(path)));
    return std::nullopt;
  }
}

}  // namespace dmvv::voml
