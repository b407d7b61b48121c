// Makes a support mesh for a scene: the surface of what is not empty in it.
//
//   make_support_mesh SCENE FILE.ply [CELLS [T_MS]]    CELLS along an edge of the standard cube, 64 if not given
//
// Marching tetrahedra (Doi and Koide 1991) over a lattice a little larger than the standard cube. The scene's shader says
// where it is empty; each crossing is found by bisection, and the mesh keeps the end that is not empty. Then all points are
// drawn in by 6 % of a cell, so that faces stay within the scene where its surface is hollow, unless it bends by more than
// that over a cell.
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/compile.h"
#include "examples/assets.h"
#include "runtime/runtime.h"
#include "voml/files.h"
#include "voml/scene.h"

namespace {

using namespace dmvv;
using assets::Mesh;
using glm::dvec3;

/// Says which points of a scene are not empty.
class Scene {
 public:
  static Result<Scene> open(const compiler::Module& module, double time_ms) {
    Diagnostics diagnostics;
    auto program = compiler::compile(module, {}, diagnostics);
    if (!program) return fail(Fault::input, diagnostics.render());
    if (auto compiled = compiler::to_spirv(*program, compiler::Kernel::points); !compiled) return tl::unexpected(compiled.error());
    auto device = runtime::Device::create({});
    if (!device) return tl::unexpected(device.error());
    auto evaluator = runtime::Evaluator::create(*device, *program);
    if (!evaluator) return tl::unexpected(evaluator.error());
    return Scene(std::move(*device), std::move(*evaluator), time_ms);
  }
  Result<std::vector<char>> filled(const std::vector<dvec3>& points) {
    std::vector<char> answer;
    if (points.empty()) return answer;
    const auto answers = evaluator_.probe(points, time_ms_);
    if (!answers) return tl::unexpected(answers.error());
    for (const auto& point : *answers) answer.push_back(point.number != 0);
    return answer;
  }

 private:
  Scene(runtime::Device device, runtime::Evaluator evaluator, double time_ms)
      : device_(std::move(device)), evaluator_(std::move(evaluator)), time_ms_(time_ms) {}
  runtime::Device device_;
  runtime::Evaluator evaluator_;
  double time_ms_;
};

class Mesher {
 public:
  explicit Mesher(int cells) : n_(cells + 2) {}

  Result<Mesh> run(Scene& scene) {
    std::vector<dvec3> places;
    for (int i = 0; i < (n_ + 1) * (n_ + 1) * (n_ + 1); ++i) places.push_back(place(i));
    auto filled = scene.filled(places);
    if (!filled) return tl::unexpected(filled.error());
    filled_ = std::move(*filled);
    make_triangles();
    if (auto done = bisect(scene); !done) return tl::unexpected(done.error());
    if (auto done = draw_in(scene); !done) return tl::unexpected(done.error());
    return std::move(mesh_);
  }

 private:
  int number(int x, int y, int z) const { return (z * (n_ + 1) + y) * (n_ + 1) + x; }
  /// From a cell outside one face of the standard cube to one outside the opposite face.
  dvec3 place(int i) const {
    const dvec3 c(i % (n_ + 1), i / (n_ + 1) % (n_ + 1), i / (n_ + 1) / (n_ + 1));
    return (c / double(n_) * 2.0 - 1.0) * (double(n_) / double(n_ - 2));
  }
  bool filled(int i) const { return filled_[static_cast<std::size_t>(i)] != 0; }

  /// The mesh's point between a filled place and an empty one.
  std::uint32_t crossing(int full, int empty) {
    const auto [entry, is_new] = known_.try_emplace({full, empty}, static_cast<std::uint32_t>(mesh_.points.size()));
    if (is_new) {
      mesh_.points.push_back(place(full));
      outside_.push_back(place(empty));
    }
    return entry->second;
  }

  void make_triangles() {
    // Six tetrahedra a cell around the diagonal from corner 0 to corner 7; bit 0 of a corner is x, 1 is y, 2 is z.
    constexpr std::array<std::array<int, 4>, 6> tetrahedra{
        {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
    for (int z = 0; z < n_; ++z)
      for (int y = 0; y < n_; ++y)
        for (int x = 0; x < n_; ++x)
          for (const auto& corners : tetrahedra) {
            std::array<int, 4> at{};
            for (std::size_t i = 0; i < 4; ++i) at[i] = number(x + (corners[i] & 1), y + (corners[i] >> 1 & 1), z + (corners[i] >> 2));
            march(at);
          }
  }

  /// The tetrahedra are right-handed; filled corners are brought to the front by even permutations, which keep that.
  void march(std::array<int, 4> t) {
    const int count = filled(t[0]) + filled(t[1]) + filled(t[2]) + filled(t[3]);
    if (count == 0 || count == 4) return;
    if (count != 2) {
      const bool lone = count == 3;  // one empty corner among filled ones, or the other way round
      std::size_t i = 0;
      while (filled(t[i]) == lone) ++i;
      if (i == 1) t = {t[1], t[0], t[3], t[2]};
      if (i == 2) t = {t[2], t[3], t[0], t[1]};
      if (i == 3) t = {t[3], t[2], t[1], t[0]};
      const auto cut = [&](int other) { return lone ? crossing(other, t[0]) : crossing(t[0], other); };
      const std::uint32_t a = cut(t[1]), b = cut(t[2]), c = cut(t[3]);
      mesh_.triangles.push_back(lone ? glm::uvec3(a, c, b) : glm::uvec3(a, b, c));
      return;
    }
    if (filled(t[0]) != filled(t[1]))
      t = filled(t[0]) == filled(t[2]) ? std::array<int, 4>{t[0], t[2], t[3], t[1]} : std::array<int, 4>{t[0], t[3], t[1], t[2]};
    if (!filled(t[0])) t = {t[2], t[3], t[0], t[1]};
    const std::uint32_t a = crossing(t[0], t[2]), b = crossing(t[0], t[3]), c = crossing(t[1], t[3]), d = crossing(t[1], t[2]);
    mesh_.triangles.emplace_back(a, b, c);
    mesh_.triangles.emplace_back(a, c, d);
  }

  Result<void> bisect(Scene& scene) {
    std::vector<dvec3> middles(mesh_.points.size());
    for (int step = 0; step < 12; ++step) {
      for (std::size_t i = 0; i < middles.size(); ++i) middles[i] = 0.5 * (mesh_.points[i] + outside_[i]);
      const auto inside = scene.filled(middles);
      if (!inside) return tl::unexpected(inside.error());
      for (std::size_t i = 0; i < middles.size(); ++i) ((*inside)[i] != 0 ? mesh_.points : outside_)[i] = middles[i];
    }
    return {};
  }

  /// All points move inward by some of a cell, those that stay within the scene.
  Result<void> draw_in(Scene& scene) {
    std::vector<dvec3> normals(mesh_.points.size(), dvec3(0.0)), moved;
    for (const glm::uvec3 t : mesh_.triangles) {
      const dvec3 a = mesh_.points[t.x], n = glm::cross(mesh_.points[t.y] - a, mesh_.points[t.z] - a);
      for (int c = 0; c < 3; ++c) normals[t[c]] += n;
    }
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const double length = glm::length(normals[i]);
      moved.push_back(mesh_.points[i] - (length == 0.0 ? dvec3(0.0) : normals[i] * (0.12 / (n_ - 2) / length)));
    }
    const auto inside = scene.filled(moved);
    if (!inside) return tl::unexpected(inside.error());
    for (std::size_t i = 0; i < moved.size(); ++i)
      if ((*inside)[i] != 0) mesh_.points[i] = moved[i];
    return {};
  }

  int n_;
  std::vector<char> filled_;
  std::map<std::pair<int, int>, std::uint32_t> known_;
  std::vector<dvec3> outside_;  ///< the empty ends of the edges whose filled ends are the mesh's points
  Mesh mesh_;
};

template <class T>
bool parse(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

int main(int argc, char** argv) {
  int cells = 64;
  double time_ms = 0.0;
  if (argc < 3 || argc > 5 || (argc > 3 && (!parse(argv[3], cells) || cells < 2 || cells > 512)) || (argc > 4 && !parse(argv[4], time_ms))) {
    fmt::print(stderr, "usage: make_support_mesh SCENE FILE.ply [CELLS [T_MS]]\n");
    return 2;
  }
  Diagnostics diagnostics;
  auto scene = voml::read_scene(argv[1], disk_files(), {}, diagnostics);
  const auto module = scene ? compiler::lower(std::move(*scene), diagnostics) : std::nullopt;
  if (!module) {
    fmt::print(stderr, "{}", diagnostics.render());
    return 1;
  }
  auto opened = Scene::open(*module, time_ms);
  auto mesh = opened ? Mesher(cells).run(*opened) : Result<Mesh>(tl::unexpected(opened.error()));
  if (!mesh) {
    fmt::print(stderr, "make_support_mesh: {}\n", mesh.error().message);
    return 2;
  }
  if (const auto written = write_file(argv[2], assets::to_ply(*mesh, "support mesh")); !written) {
    fmt::print(stderr, "make_support_mesh: {}\n", written.error().message);
    return 2;
  }
}
