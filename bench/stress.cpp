#include "bench/stress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "base/files.h"
#include "bench/stress_scenes.h"
#include "compiler/compile.h"
#include "compiler/ir/affine.h"
#include "compiler/ir/legend.h"
#include "compiler/layout/flatten.h"
#include "compiler/program_file.h"
#include "compiler/reference/reference.h"

namespace dmvv::stress {

namespace {

using Points = std::vector<glm::dvec3>;

struct Form {
  std::string name;
  compiler::CompileOptions options;
};

const std::vector<Form>& forms() {
  static const std::vector<Form> all = [] {
    std::vector<Form> made{{"specialised", {}}, {"table", {}}, {"mixed", {}}};
    made[1].options.codegen = compiler::Codegen::table;
    made[2].options.inlined_line_budget = 60;
    return made;
  }();
  return all;
}

/// What comparing a scene's answers came to, over all forms of code and times.
struct Tally {
  std::size_t asked = 0;
  std::size_t certain = 0;
  std::size_t wrong = 0;      ///< certain, and not what the reference says
  std::size_t different = 0;  ///< certain or not
  std::string first_wrong, first_different;
};

/// A module, and what was said about it.
struct Lowered {
  std::optional<compiler::Module> module;
  std::string messages;
};

Lowered lowered(const StressScene& scene) {
  auto files = scene.files;
  files["stress.voml"] = scene.text;
  Diagnostics diagnostics;
  Lowered made;
  if (auto read = voml::read_scene("stress.voml", memory_files(std::move(files)), {}, diagnostics)) {
    made.module = compiler::lower(std::move(*read), diagnostics);
  }
  made.messages = diagnostics.render();
  return made;
}

std::string describe(const glm::dvec3& p) { return fmt::format("({:.17g} {:.17g} {:.17g})", p.x, p.y, p.z); }

class Runner {
 public:
  Runner(runtime::Device& device, const Options& options, const std::function<void(const Case&)>& done)
      : device_(device), options_(options), done_(done) {}

  Result<std::vector<Case>> run() {
    deep_chains();
    zooms();
    matrices();
    boundaries();
    values();
    structures();
    determinism();
    if (failed_) return tl::unexpected<Error>(*failed_);
    return std::move(cases_);
  }

 private:
  // ---- cases ----

  void add(Case made) {
    if (failed_) return;
    made.held = made.at_least ? made.measured >= made.bound : made.measured <= made.bound;
    cases_.push_back(std::move(made));
    if (done_) done_(cases_.back());
  }

  void at_most(std::string name, std::string what, double measured, double bound, std::string unit,
               std::string detail = {}) {
    add({std::move(name), std::move(what), measured, bound, false, std::move(unit), std::move(detail)});
  }
  void at_least(std::string name, std::string what, double measured, double bound, std::string unit,
                std::string detail = {}) {
    add({std::move(name), std::move(what), measured, bound, true, std::move(unit), std::move(detail)});
  }

  template <class T>
  bool ok(const Result<T>& result) {
    if (!result && !failed_) failed_ = result.error();
    return result.has_value() && !failed_;
  }

  // ---- machinery ----

  std::optional<compiler::Program> compiled(const compiler::Module& module, const compiler::CompileOptions& options,
                                            compiler::Source source) {
    Diagnostics diagnostics;
    auto program = compiler::compile(module, options, diagnostics);
    if (!program) {
      if (!failed_) failed_ = Error{Fault::input, diagnostics.render(), {}};
      return std::nullopt;
    }
    if (!ok(compiler::to_spirv(*program, source))) return std::nullopt;
    return program;
  }

  Tally compare(const compiler::Module& module, const Points& points, const std::vector<double>& times = {0.0}) {
    Tally tally;
    if (failed_) return tally;
    const compiler::Reference reference(module);
    const auto legend = compiler::legend(module);
    for (const Form& form : forms()) {
      const auto program = compiled(module, form.options, compiler::Source::points);
      if (!program) return tally;
      auto evaluator = runtime::Evaluator::create(device_, *program);
      if (!ok(evaluator)) return tally;
      for (const double time : times) {
        const auto answers = evaluator->probe(points, time);
        if (!ok(answers)) return tally;
        for (std::size_t i = 0; i < points.size(); ++i) {
          count(tally, reference.evaluate(points[i], time), answers->at(i), legend, program->regions,
                fmt::format("{} at {}, time {}", form.name, describe(points[i]), time));
        }
      }
    }
    return tally;
  }

  static void count(Tally& tally, const compiler::ReferenceAnswer& expected, const compiler::PointAnswer& got,
                    const std::vector<compiler::RegionInfo>& legend, const std::vector<compiler::RegionInfo>& regions,
                    const std::string& where) {
    ++tally.asked;
    tally.certain += expected.certain ? 1 : 0;
    const std::string expected_path = compiler::format_path(legend, expected.path);
    const std::string path = compiler::format_path(regions, got.path);
    if (got.number == expected.number && path == expected_path) return;
    const std::string what = fmt::format("{}: '{}' instead of '{}'", where, path, expected_path);
    if (tally.different++ == 0) tally.first_different = what;
    if (expected.certain && tally.wrong++ == 0) tally.first_wrong = what;
  }

  /// The two figures of most scenes. With `exact`, all that the points and placements go through is exact in float32:
  /// then boundaries must agree as well.
  void check(const std::string& name, const std::string& what, const StressScene& scene, const Points& points,
             double least_certain, bool exact = false, const std::vector<double>& times = {0.0}) {
    const Lowered made = lowered(scene);
    if (!made.module) return at_most(name, what, 1, 0, "refused scenes", made.messages);
    const Tally tally = compare(*made.module, points, times);
    if (exact) {
      at_most(name + ": different", what, double(tally.different), 0, "points", tally.first_different);
    } else {
      at_most(name + ": wrong", what, double(tally.wrong), 0, "points", tally.first_wrong);
    }
    if (least_certain > 0) {
      at_least(name + ": certain", "share of points of which the reference is certain",
               double(tally.certain) / double(std::max<std::size_t>(tally.asked, 1)), least_certain, "share");
    }
  }

  /// A scene that must be refused, with a code.
  void refused(const std::string& name, const std::string& what, const StressScene& scene, const std::string& code) {
    const Lowered made = lowered(scene);
    at_most(name, what, !made.module && made.messages.find(code) != std::string::npos ? 0 : 1, 0, "accepted scenes",
            made.module ? "accepted" : made.messages);
  }

  Points random_points(std::uint64_t seed, int count, double extent = 1.0) const {
    Random random(seed);
    Points points;
    for (int i = 0; i < (options_.long_form ? 10 : 1) * count; ++i) points.push_back(random.point(-extent, extent));
    return points;
  }

  void deep_chains();
  void deep_chain_of(double scale, int levels, double least_warned);
  void zooms();
  void matrices();
  void boundaries();
  void values();
  void structures();
  void determinism();

  runtime::Device& device_;
  Options options_;
  const std::function<void(const Case&)>& done_;
  std::vector<Case> cases_;
  std::optional<Error> failed_;
};

// ---- deep embedding ----

/// The first level that W0301 speaks of; levels + 1 if there is none.
int warned_level(const std::string& messages, int levels) {
  const std::size_t at = messages.find("the object 'L");
  return messages.find("W0301") == std::string::npos || at == std::string::npos ? levels + 1
                                                                                : std::atoi(&messages[at + 13]);
}

void Runner::deep_chain_of(double scale, int levels, double least_warned) {
  const Lowered made = lowered(deep_chain(levels, scale));
  const std::string name = fmt::format("deep/{} x {}", scale, levels);
  if (!made.module) return at_most(name, "a chain of embeddings", 1, 0, "refused scenes", made.messages);

  // Points near the middle of each level's object, in root coordinates.
  const compiler::Affine outer = compiler::object_from_local({{0.1, 0.05, -0.1}, {10, 20, 30}, glm::dvec3(scale)});
  compiler::Affine root_from_level;
  Random random(11);
  const int each = options_.long_form ? 2000 : 100;
  Points points;
  for (int level = 0; level < levels; ++level) {
    for (int i = 0; i < each; ++i) points.push_back(root_from_level(random.point()));
    root_from_level = root_from_level * outer;
  }
  const Tally tally = compare(*made.module, points);
  at_most(name + ": wrong", "points in the cube of every level of a chain, all forms of code", double(tally.wrong), 0,
          "points", tally.first_wrong);

  // Where float32 gives up: the share of certain points of each level, against the level that is warned of.
  const compiler::Reference reference(*made.module);
  const int warned = warned_level(made.messages, levels);
  double worst_before = 1.0;
  int last_useful = -1;
  for (int level = 0; level < levels; ++level) {
    int certain = 0;
    for (int i = 0; i < each; ++i) certain += reference.evaluate(points[std::size_t(level * each + i)]).certain ? 1 : 0;
    const double share = double(certain) / each;
    if (level < warned) worst_before = std::min(worst_before, share);
    if (share >= 0.5) last_useful = level;
  }
  at_least(name + ": unwarned", "levels before float32 is too coarse: the warned one's number", warned, least_warned,
           "levels");
  at_least(name + ": certain before", "least share of certain points at a level that is not warned of", worst_before,
           0.95, "share", fmt::format("half of the points are certain down to level {}", last_useful));
}

void Runner::deep_chains() {
  deep_chain_of(0.5, 40, 10);
  deep_chain_of(0.1, 12, 3);
  deep_chain_of(0.01, 6, 2);
}

// ---- zooming ----

constexpr double zoomed_at[2] = {0.3127, 0.2131};

/// Square tubes along z: cells of 2 * scale, |x| or |y| < 1/2 inside.
StressScene zoom_scene(double scale) {
  return one_sdf(
      fmt::format("type='tiling' scale='{0} {0} 2' translate='{1} {2} 0' function='true'>return max(abs(p.x), "
                  "abs(p.y)) - 0.5;</SDF>",
                  scale, zoomed_at[0], zoomed_at[1]));
}

void Runner::zooms() {
  double worst_error = 0.0, deepest = 0.0;
  std::string where;
  constexpr std::uint32_t n = 64;
  for (int decade = 0; decade <= 6; ++decade) {
    const double field = 2.0 * std::pow(10.0, -decade), pixel = field / n;  // root units
    const double scale = field / 16.0;
    const Lowered made = lowered(zoom_scene(scale));
    if (!made.module) return at_most("zoom", "a zooming camera", 1, 0, "refused scenes", made.messages);
    const auto program = compiled(*made.module, {}, compiler::Source::surface);
    if (!program) return;
    auto evaluator = runtime::Evaluator::create(device_, *program);
    if (!ok(evaluator)) return;
    runtime::View view;
    view.size_px = {n, n};
    view.camera.look = {zoomed_at[0], zoomed_at[1], 1.0};
    view.camera.eye = view.camera.look + glm::dvec3(0.0, 0.0, field);
    view.camera.fov_deg = 2.0 * std::atan(0.5) * 180.0 / std::numbers::pi;  // as wide as the eye is away
    view.want_regions = true;
    const auto picture = evaluator->render(view);
    if (!ok(picture)) return;

    std::uint32_t inside = 0;
    for (const compiler::Region& region : made.module->regions) inside = region.name == "IN" ? region.number : inside;
    // A pixel of the wrong region shows a point that is at least as far off as the boundary is.
    double error = 0.0;
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        const glm::dvec2 local{(x + 0.5 - n / 2.0) * pixel, (n / 2.0 - y - 0.5) * pixel};
        const glm::dvec3 p(zoomed_at[0] + local.x, zoomed_at[1] + local.y, 1.0);
        if (std::abs(p.x) > 1.0 || std::abs(p.y) > 1.0) continue;
        glm::dvec2 q = local / scale;
        q -= 2.0 * glm::floor((q + 1.0) * 0.5);
        const double f = std::max(std::abs(q.x), std::abs(q.y)) - 0.5;
        const std::uint32_t got = picture->regions[x + std::size_t{n} * y];
        if ((got == inside) != (f <= 0.0)) error = std::max(error, std::abs(f) * scale);
      }
    }
    if (error > worst_error) where = fmt::format("at a zoom of 10^{}", decade);
    worst_error = std::max(worst_error, error);
    if (error < pixel) deepest = decade;
    if (error >= pixel) break;
  }
  at_most("zoom: position", "how far off a surface point is where a camera comes near", worst_error * 0x1p24, 8.5,
          "2^-24", where);
  at_least("zoom: decades", "zoom at which points are still off by less than a pixel of a picture 64 pixels wide",
           deepest, 4, "decades");
}

// ---- matrices ----

void Runner::matrices() {
  // A thousand rotations composed in double stay a rotation.
  compiler::Affine turned;
  const compiler::Affine step = compiler::object_from_local({{}, {1.7, -2.9, 7.3}, glm::dvec3(1.0)});
  for (int i = 0; i < 1000; ++i) turned = step * turned;
  double off = 0.0;
  const glm::dmat3 product = glm::transpose(turned.linear) * turned.linear;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) off = std::max(off, std::abs(product[i][k] - (i == k ? 1.0 : 0.0)));
  }
  at_most("matrices: thousand rotations", "orthogonality of 1,000 composed rotations", off, 1e-12, "units");

  // 250 levels that turn and do not shrink: every frame's point is known in double.
  std::string chain;
  for (int i = 249; i >= 0; --i) {
    chain += fmt::format(
        "<OBJECT name='L{}'><REGION name='IN' type='color' rgb='1 0 0'>{}</REGION>{}</OBJECT>\n", i,
        i < 249 ? fmt::format("<EMBEDDED name='L{}' rotate='1.7 -2.9 7.3'/>", i + 1) : "",
        i == 249
            ? "<SDF name='S' function='true'>return p.x + 0.3 * p.y;</SDF><REGION name='OUT' type='color' rgb='0 1 0'/>"
              "<MAPPINGS><SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS>"
            : "");
  }
  check("matrices: 250 levels turned", "a chain of 250 rotations without scale", {"<MVV>" + chain + "</MVV>", {}},
        random_points(5, 500, 0.55), 0.9);

  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    const double reach = std::min(1.0, 2.0 * scale);
    check(
        fmt::format("matrices: scale {:g}", scale), "an SDF of that size, turned and mirrored",
        one_sdf(fmt::format(
            "function='true' scale='{0} -{0} {0}' rotate='20 30 40'>return length(p - vec3(0.1)) - 0.7;</SDF>", scale)),
        random_points(6, 2000, reach), 0.99);
  }
  check("matrices: nearly singular", "an SDF a million times longer than thick",
        one_sdf("function='true' scale='1000 1e-3 1' rotate='0 0 30'>return length(p) - 0.9;</SDF>"),
        random_points(7, 4000), 0.99);
  refused("matrices: beyond float32", "a placement of which float32 cannot hold the matrix",
          one_sdf("function='true' scale='1e-37 1e-37 1e-37' rotate='1 2 3'>return length(p);</SDF>"), "E0306");
}

// ---- boundaries, exactly ----

/// Multiples of 1/8 in the cube, its faces included: exact in float32, and on every boundary of the scenes below.
Points lattice() {
  Points points;
  for (int z = -8; z <= 8; ++z) {
    for (int y = -8; y <= 8; ++y) {
      for (int x = -8; x <= 8; ++x) points.push_back(glm::dvec3(x, y, z) / 8.0);
    }
  }
  return points;
}

void Runner::boundaries() {
  const std::string ball = lxn_of(16, [](glm::dvec3 p) { return glm::length(p) - 0.75; });
  check("boundaries: cube faces", "points on the faces of embedded cubes that touch",
        {"<MVV><OBJECT name='C'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT><OBJECT name='D'><REGION name='R' "
         "type='color' rgb='0 1 0'/></OBJECT><OBJECT name='A'><REGION name='R' type='color' rgb='0 0 1'><EMBEDDED "
         "name='C' "
         "translate='-0.5 0 0' scale='0.5 0.5 0.25'/><EMBEDDED name='D' translate='0.5 0 0' scale='0.5 0.5 "
         "0.5'/><EMBEDDED "
         "name='C' rotate='0 90 0' scale='0.125 1 1'/></REGION></OBJECT></MVV>",
         {}},
        lattice(), 0, true);
  std::string seeds;  // 8^3 touching cubes: every cell border of their index is a face
  for (int i = 0; i < 512; ++i) {
    const glm::ivec3 at(i % 8, i / 8 % 8, i / 64);
    seeds += fmt::format("{} {} {}\n", (at.x - 3.5) / 8.0, (at.y - 3.5) / 8.0, (at.z - 3.5) / 8.0);
  }
  check("boundaries: index cells", "seeds whose cubes fill space without a gap, points on the cells' borders",
        {"<MVV><OBJECT name='C'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT><OBJECT name='A'><REGION name='R' "
         "type='color' rgb='0 0 1'><INDEX size='8 8 8'><EMBEDDED name='C' seedFile='s.txt' scale='0.125 0.125 "
         "0.125'/></INDEX>"
         "</REGION></OBJECT></MVV>",
         {{"s.txt", seeds}}},
        lattice(), 0, true);
  check("boundaries: tile seams", "points on the seams of a tiling",
        one_sdf("type='tiling' scale='0.25 0.25 0.25' function='true'>return abs(p.x) - 0.5;</SDF>"), lattice(), 0,
        true);
  check("boundaries: coplanar", "two SDFs that share a plane, points on it",
        {"<MVV><OBJECT name='A'><SDF name='P' function='true'>return p.x - 0.25;</SDF><SDF name='Q' function='true' "
         "scale='0.5 "
         "0.5 0.5' translate='0.25 0 0'>return -p.x;</SDF><REGION name='L' type='color' rgb='1 0 0'/><REGION name='M' "
         "type='color' "
         "rgb='0 1 0'/><REGION name='R' type='color' rgb='0 0 1'/><MAPPINGS><SDF name='P'><NEGATIVE><SDF "
         "name='Q'><POSITIVE "
         "region='L'/><NEGATIVE region='M'/></SDF></NEGATIVE><POSITIVE region='R'/></SDF></MAPPINGS></OBJECT></MVV>",
         {}},
        lattice(), 0, true);
  check("boundaries: zeros of grids", "points at samples that are zero, and between them",
        one_sdf("file='g.lxn'/>", {{"g.lxn", lxn_of(8, [](glm::dvec3 p) { return p.x * p.y * p.z > 0 ? 0.0 : 1.0; })}}),
        lattice(), 0);
  // Two grids that fill an atlas, opposite signs: bleeding would show at once.
  check("boundaries: atlas borders", "points on the faces of grids that lie side by side in the atlas",
        {"<MVV><OBJECT name='A'><SDF name='P' file='p.lxn'/><SDF name='Q' file='q.lxn'/><SDF name='B' "
         "file='b.lxn'/><REGION name='X' "
         "type='color' rgb='1 0 0'/><REGION name='Y' type='color' rgb='0 1 0'/><MAPPINGS><SDF name='P'><NEGATIVE "
         "region='X'/><POSITIVE>"
         "<SDF name='Q'><POSITIVE region='X'/><NEGATIVE><SDF name='B'><POSITIVE region='Y'/><NEGATIVE "
         "region='X'/></SDF></NEGATIVE></SDF>"
         "</POSITIVE></SDF></MAPPINGS></OBJECT></MVV>",
         {{"p.lxn", lxn_of(5, [](glm::dvec3) { return 1.0; })},
          {"q.lxn", lxn_of(7, [](glm::dvec3) { return -1.0; })},
          {"b.lxn", ball}}},
        lattice(), 0);
}

// ---- values ----

void Runner::values() {
  const auto grid = [](const std::function<double(glm::dvec3)>& f) {
    return one_sdf("file='g.lxn'/>", {{"g.lxn", lxn_of(12, f)}});
  };
  const Points points = random_points(21, 2000);
  check("values: huge grid", "a grid of values up to 3e38",
        grid([](glm::dvec3 p) { return 3e38 * std::clamp(p.x, -1.0, 1.0); }), points, 0.9);
  check("values: denormal grid", "a grid of values around 1e-40", grid([](glm::dvec3 p) { return 1e-40 * p.x; }),
        points, 0);
  check("values: flat grid", "a grid without gradient, exactly at zero", grid([](glm::dvec3) { return 0.0; }), points,
        0);
  check("values: thin shell", "a shell one voxel wide in a grid",
        grid([](glm::dvec3 p) { return std::abs(glm::length(p) - 0.6) < 1.0 / 12.0 ? -1.0 : 1.0; }), points, 0.9);
  check("values: no distance", "a checkerboard of random values",
        grid([](glm::dvec3 p) { return std::sin(1e4 * p.x + 2e4 * p.y + 3e4 * p.z); }), points, 0.9);
  check(
      "values: steep", "values between -1e6 and 1e6 from sample to sample, threshold beside zero",
      one_sdf("file='g.lxn' offset='1e-3'/>",
              {{"g.lxn", lxn_of(12, [](glm::dvec3 p) { return 1e6 * std::sin(1e4 * p.x + 2e4 * p.y + 3e4 * p.z); })}}),
      points, 0.9);

  const std::pair<const char*, const char*> snippets[] = {
      {"NaN", "return sqrt(p.x);"},
      {"0/0", "float z = p.x - p.x; return z / z;"},
      {"infinite", "return p.x / 0.0;"},
      {"overflow", "float a = 1e38 * p.x; return a * a * a;"},
      {"denormal", "return 1e-30 * p.x * 1e-10;"},
      {"magnitudes", "return 1e30 * (p.x * p.x + p.y * p.y - 0.5) + 1e20 * p.z;"},
      {"cancellation", "return (p.x + 1e6) - 1e6 - p.y;"},
      {"flat", "return pow(abs(p.x), 9.0) * 1e-6 - 1e-9;"},
      {"no distance", "return fract(sin(dot(floor(p * 8.0), vec3(12.9898, 78.233, 37.719))) * 43758.5453) - 0.5;"},
      {"arcs", "return atan(p.y, p.x) + asin(p.z) - acos(p.x * p.y) * atan(3.0 * p.z);"},
      {"hyperbolic", "return tanh(5.0 * p.x) + asinh(9.0 * p.y) - acosh(1.0 + p.z * p.z) - sinh(p.x) * 0.3;"},
  };
  for (const auto& [name, body] : snippets) {
    check(fmt::format("values: snippet {}", name), body,
          one_sdf(fmt::format("function='true'><![CDATA[{}]]></SDF>", body)), points, 0);
  }
  check("values: time", "a scene that moves, from its start to a day later",
        one_sdf("function='true'>float a = t * 0.002; return length(p - 0.4 * vec3(cos(a), sin(a), sin(5.0 * p.x + t / "
                "300.0))) "
                "- 0.3 - 0.1 * fract(t / 777.0);</SDF>"),
        points, 0.99, false, {0.0, 1.0, 3.6e6, 86399999.75, 86.4e6});
}

// ---- structures ----

void Runner::structures() {
  const Points points = random_points(31, 500);
  // lavapipe ignores conditions nested beyond 80.
  for (const int levels : {30, 60, 90, 1000}) {
    check(fmt::format("structures: tree {} deep", levels), "decisions nested", deep_tree(levels), points, 0.9);
  }
  std::string returns, branches, ends;
  for (int i = 0; i < 46; ++i) {
    const double x = -1.0 + 2.0 * (i + 1) / 47.0;
    returns += fmt::format("if (p.x < {:.7f}) return {:.1f};\n", x, i % 2 == 0 ? 1.0 : -1.0);
    branches += fmt::format("if (p.x < {:.7f}) {{ d = {:.1f} + p.y; }} else {{\n", x, i % 2 == 0 ? 1.5 : -1.5);
    ends += "}";
  }
  check("structures: 46 returns", "a snippet of early returns",
        one_sdf(fmt::format("function='true'><![CDATA[{} return p.y;]]></SDF>", returns)), points, 0.9);
  check(
      "structures: 46 branches", "a snippet of nested branches",
      one_sdf(fmt::format("function='true'><![CDATA[float d = p.y; {} d = p.z; {} return d;]]></SDF>", branches, ends)),
      points, 0.9);
  std::string objects, embedded;
  for (int i = 0; i < 100; ++i) {
    objects += fmt::format("<OBJECT name='O{0}'><REGION name='R' type='color' rgb='{1} 0 0'/></OBJECT>", i, i / 100.0);
    embedded += fmt::format("<EMBEDDED name='O{}' translate='{:.4f} 0 0' scale='0.01 1 1'/>", i, -0.99 + 0.02 * i);
  }
  check("structures: 100 objects", "a hundred different objects side by side in a region",
        {"<MVV>" + objects + "<OBJECT name='A'><REGION name='R' type='color' rgb='0 0 1'>" + embedded +
             "</REGION></OBJECT></MVV>",
         {}},
        points, 0.9);
  const int many = options_.long_form ? 1000000 : 100000;
  check(fmt::format("structures: {} seeds", many), "seeds of an analytic ball",
        one_sdf("type='seeding' seedFile='s.txt' scale='0.01 0.01 0.01' function='true'>return length(p) - 0.9;</SDF>",
                {{"s.txt", seed_lines(many, 3, 0.5)}}),
        points, 0.9);
  std::string same;
  for (int i = 0; i < 5000; ++i) same += "0.1 0.1 0.1\n";
  check("structures: one cell", "5,000 seeds at the same place",
        one_sdf("type='seeding' seedFile='s.txt' scale='0.3 0.3 0.3' function='true'>return length(p) - 0.9;</SDF>",
                {{"s.txt", same}}),
        random_points(32, 100), 0.9);
  check("structures: nothing", "empty regions, no seeds, an embedded object that is empty",
        {"<MVV><OBJECT name='E'><REGION name='R' type='empty'/></OBJECT><OBJECT name='A'><SDF name='S' type='seeding' "
         "seedFile='s.txt' function='true'>return -1.0;</SDF><REGION name='IN' type='empty'/><REGION name='OUT' "
         "type='empty'>"
         "<INDEX size='1 1 1'/><EMBEDDED name='E' seedFile='s.txt'/><EMBEDDED name='E' scale='0.5 0.5 "
         "0.5'/></REGION><MAPPINGS>"
         "<SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT></MVV>",
         {{"s.txt", ""}}},
        points, 0.9);
}

// ---- determinism ----

void Runner::determinism() {
  StressScene scene = deep_chain(5, 0.6);
  scene.text.insert(
      scene.text.rfind("<OBJECT name='L0'"),
      "<OBJECT name='G'><SDF name='S' file='g.lxn' type='seeding' seedFile='s.txt' scale='0.2 0.3 0.2'/><REGION "
      "name='IN' type='color' rgb='1 1 0'/><REGION name='OUT' type='empty'/><MAPPINGS><SDF name='S'><POSITIVE "
      "region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT>");
  scene.text.replace(scene.text.rfind("</REGION>"), 0,
                     "<EMBEDDED name='G' seedFile='s.txt' scale='0.3 0.3 0.3' rotate='3 4 5'/>");
  scene.files = {{"g.lxn", lxn_of(12, [](glm::dvec3 p) { return glm::length(p) - 0.7; })},
                 {"s.txt", seed_lines(200, 9, 0.4)}};
  int different_bytes = 0, different_pixels = 0;
  std::string detail;
  for (const Form& form : forms()) {
    std::string bytes;
    std::vector<float> pixels;
    // Twice here, then on devices of their own with one thread and two.
    for (const char* threads : {"", "", "1", "2"}) {
      const Lowered made = lowered(scene);
      if (!made.module) return at_most("determinism", "a scene", 1, 0, "refused scenes", made.messages);
      const auto program = compiled(*made.module, form.options, compiler::Source::surface);
      if (!program) return;
      const std::string now = compiler::write_program(*program);
      if (!bytes.empty() && now != bytes) ++different_bytes;
      bytes = now;
      std::optional<runtime::Device> own;
      if (*threads != 0) {
        const char* before = std::getenv("LP_NUM_THREADS");
        const std::string kept = before != nullptr ? before : "";
        setenv("LP_NUM_THREADS", threads, 1);
        auto opened = runtime::Device::create({.name = device_.info().name});
        before != nullptr ? setenv("LP_NUM_THREADS", kept.c_str(), 1) : unsetenv("LP_NUM_THREADS");
        if (!ok(opened)) return;
        own = std::move(*opened);
      }
      auto evaluator = runtime::Evaluator::create(own ? *own : device_, *program);
      if (!ok(evaluator)) return;
      runtime::View view;
      view.size_px = {160, 120};
      view.cuts = {{{0.3, 1.0, 0.2}, 0.05}};
      view.camera = runtime::default_camera({glm::dvec3(-1.0), glm::dvec3(1.0)}, view.size_px, view.cuts);
      const auto picture = evaluator->render(view);
      if (!ok(picture)) return;
      if (!pixels.empty() && picture->rgba != pixels) {
        ++different_pixels;
        detail = fmt::format("{}, threads '{}'", form.name, threads);
      }
      pixels = picture->rgba;
    }
  }
  at_most("determinism: programs", "compiled again, every byte of code, records and textures is the same",
          different_bytes, 0, "programs");
  at_most("determinism: pictures", "drawn again, and with one thread and two, every value is the same",
          different_pixels, 0, "pictures", detail);
}

}  // namespace

Result<std::vector<Case>> run(runtime::Device& device, const Options& options,
                              const std::function<void(const Case&)>& done) {
  return Runner(device, options, done).run();
}

}  // namespace dmvv::stress
