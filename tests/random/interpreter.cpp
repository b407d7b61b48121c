// A scene's description evaluated as spec/voml.md reads, in double and without any shortcut.
#include <fmt/format.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>

#include "compiler/grids/sample.h"
#include "compiler/reference/reference.h"
#include "tests/random/check.h"
#include "voml/assets/grid.h"

namespace dmvv::tests::random_scenes {

namespace {

constexpr double close = 1e-9;  // what double arithmetic may differ in, times a large condition

/// Section 3: M = T * Rz * Ry * Rx * S; M^-1 p.
glm::dvec3 into_local(const Transform& t, const glm::dvec3& p) {
  const glm::dvec3 a = t.rotate_deg * (std::numbers::pi / 180.0);
  glm::dvec3 q = p - t.translate;
  q = {std::cos(a.z) * q.x + std::sin(a.z) * q.y, -std::sin(a.z) * q.x + std::cos(a.z) * q.y, q.z};
  q = {std::cos(a.y) * q.x - std::sin(a.y) * q.z, q.y, std::sin(a.y) * q.x + std::cos(a.y) * q.z};
  q = {q.x, std::cos(a.x) * q.y + std::sin(a.x) * q.z, -std::sin(a.x) * q.y + std::cos(a.x) * q.z};
  return q / t.scale;
}

/// Section 5, Seeds.
std::vector<Transform> placed(Placement placement, const Transform& t, const Seeds& seeds) {
  if (placement != Placement::seeded) return {t};
  std::vector<Transform> all;
  for (const voml::Seed& seed : seeds.lines) {
    all.push_back({2.0 * seed.position + t.translate,
                   (seeds.rotates ? seed.rotate_deg : glm::dvec3(0.0)) + t.rotate_deg,
                   (seeds.scales ? seed.scale : glm::dvec3(1.0)) * t.scale});
  }
  return all;
}

}  // namespace

struct Interpreter::Impl {
  Scene scene;
  std::map<std::string, std::string> files;
  // Sources of SDFs in reading order: grids parsed and snippets compiled, as the scene has them.
  std::vector<std::vector<std::optional<voml::Grid>>> grids;
  std::vector<std::vector<std::optional<compiler::snippet::Snippet>>> snippets;
  std::vector<std::vector<std::optional<voml::Bitmap>>> bitmaps;

  struct Asked {
    double time_ms;
    bool clear = true;
    glm::dvec4 rgba{0.0};
  };

  bool near(double x, double threshold, Asked& asked) const {
    if (std::abs(x - threshold) <= close * (1.0 + std::abs(x) + std::abs(threshold))) asked.clear = false;
    return true;
  }

  bool in_box(const glm::dvec3& q, const glm::dvec3& lo, const glm::dvec3& hi, Asked& asked) const {
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
      near(q[axis], lo[axis], asked);
      near(q[axis], hi[axis], asked);
      inside = inside && q[axis] >= lo[axis] && q[axis] <= hi[axis];
    }
    return inside;
  }

  glm::dvec3 wrapped(glm::dvec3 q, Asked& asked) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double turns = (q[axis] + 1.0) / 2.0;
      near(turns, std::round(turns), asked);
      q[axis] -= 2.0 * std::floor(turns);
    }
    return q;
  }

  /// Section 4: whether p goes to the positive side.
  bool positive(Reference r, const glm::dvec3& p, Asked& asked) const {
    const Sdf& sdf = scene.objects[r.object].sdfs[r.index];
    double least = std::numeric_limits<double>::infinity();
    for (const Transform& t : placed(sdf.placement, sdf.transform, sdf.seeds)) {
      glm::dvec3 q = into_local(t, p);
      if (sdf.placement == Placement::tiled) q = wrapped(q, asked);
      if (!in_box(q, glm::dvec3(-1.0), glm::dvec3(1.0), asked)) continue;
      double value;
      if (const auto& grid = grids[r.object][r.index]) {
        if (!in_box(q, grid->box_lo, grid->box_hi, asked)) continue;
        value = compiler::sample(*grid, q);
      } else {
        value = snippets[r.object][r.index]->evaluate(q, asked.time_ms).f;
        // A snippet may jump: a point beside this one tells.
        const auto beside = [&](double d) {
          return snippets[r.object][r.index]->evaluate(q + d, asked.time_ms).f > sdf.offset;
        };
        if (beside(1e-7) != (value > sdf.offset) || beside(-1e-7) != (value > sdf.offset)) asked.clear = false;
      }
      near(value, sdf.offset, asked);
      if (value < least) least = value;  // a NaN counts as positive
    }
    return least > sdf.offset;
  }

  std::optional<std::string> ask(std::uint32_t object, const glm::dvec3& p, Asked& asked) const {
    if (!in_box(p, glm::dvec3(-1.0), glm::dvec3(1.0), asked)) return std::nullopt;
    const Object& o = scene.objects[object];
    Reference r;
    if (o.shorthand) {
      r = {object, 0};
      if (!o.sdfs.empty() && positive(r, p, asked)) return std::nullopt;
    } else {
      const Tree* node = &o.tree;
      while (!node->sides.empty()) node = &node->sides[positive(node->what, p, asked) ? 0 : 1];
      r = node->what;
    }
    const Region& region = scene.objects[r.object].regions[r.index];
    const std::string name = fmt::format("O{}:R{}_{}", object, r.object, r.index);
    std::size_t number = 0;
    for (const Group& group : region.groups) {
      const bool held =
          !group.index || in_box(into_local(group.index->transform, p), glm::dvec3(-1.0), glm::dvec3(1.0), asked);
      for (const Embedded& child : group.embedded) {
        for (const Transform& t : placed(child.placement, child.transform, child.seeds)) {
          const std::size_t k = number++;
          if (!held) continue;
          glm::dvec3 q = into_local(t, p);
          if (child.placement == Placement::tiled) q = wrapped(q, asked);
          if (const auto inner = ask(child.object, q, asked)) return fmt::format("{}[{}]/{}", name, k, *inner);
        }
      }
    }
    if (region.kind == RegionKind::empty) return std::nullopt;
    asked.rgba = glm::dvec4(region.rgb, region.opacity);
    if (region.kind == RegionKind::bitmap) {
      asked.rgba = texel(*bitmaps[r.object][r.index], into_local(region.transform, p));
      asked.rgba.a *= region.opacity;
    }
    return name;
  }

  /// Section 6: trilinear among the nearest texels, which repeat without end.
  static glm::dvec4 texel(const voml::Bitmap& bitmap, const glm::dvec3& q) {
    const std::int64_t n = bitmap.n;
    const glm::dvec3 at = (q + 1.0) * (0.5 * static_cast<double>(n)) - 0.5;
    const glm::dvec3 base = glm::floor(at), w = at - base;
    glm::dvec4 sum(0.0);
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1.0;
      std::int64_t i[3];
      for (int axis = 0; axis < 3; ++axis) {
        const int up = corner >> axis & 1;
        weight *= up ? w[axis] : 1.0 - w[axis];
        i[axis] = ((static_cast<std::int64_t>(base[axis]) + up) % n + n) % n;
      }
      sum += weight * glm::dvec4(bitmap.texels[static_cast<std::size_t>((i[2] * n + i[1]) * n + i[0])]) / 255.0;
    }
    return sum;
  }
};

Interpreter::Interpreter(const Scene& scene) : impl_(std::make_unique<Impl>()) {
  impl_->scene = scene;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    impl_->grids.emplace_back(object.sdfs.size());
    impl_->snippets.emplace_back(object.sdfs.size());
    impl_->bitmaps.emplace_back(object.regions.size());
    for (std::uint32_t k = 0; k < object.sdfs.size(); ++k) {
      Diagnostics diagnostics;
      if (const auto* grid = std::get_if<Grid>(&object.sdfs[k].source)) {
        impl_->grids[i][k] = voml::parse_lxn(lxn_bytes(*grid), diagnostics.add_source("a.lxn", {}), diagnostics);
      } else {
        voml::Function function;
        for (const std::string& helper : {shared_helpers(), object.helpers}) {
          if (!helper.empty()) function.helpers.push_back({helper, {{0, {}}}});
        }
        function.body = {std::get<Function>(object.sdfs[k].source).body, {{0, {}}}};
        impl_->snippets[i][k] = compiler::snippet::compile_snippet(function, diagnostics);
      }
    }
    for (std::uint32_t k = 0; k < object.regions.size(); ++k) {
      Diagnostics diagnostics;
      if (object.regions[k].kind == RegionKind::bitmap) {
        impl_->bitmaps[i][k] = voml::parse_bitmap(bitmap_bytes(object.regions[k].bitmap), "a.png", {}, diagnostics);
      }
    }
  }
}
Interpreter::Interpreter(Interpreter&&) noexcept = default;
Interpreter::~Interpreter() = default;

Meaning Interpreter::at(const glm::dvec3& p, double time_ms) const {
  Impl::Asked asked{time_ms, true, {}};
  const auto path = impl_->ask(0, p, asked);
  Meaning meaning{path.value_or(""), path ? asked.rgba : glm::dvec4(0.0), asked.clear};
  return meaning;
}

}  // namespace dmvv::tests::random_scenes
