#include "bench/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "bench/workload.h"
#include "runtime/view/frame_passes.h"
#include "runtime/view/view.h"

namespace dmvv::bench {
namespace {

namespace fs = std::filesystem;
using compiler::Codegen;
using compiler::Filter;
using compiler::TexelFormat;

constexpr std::size_t surface_points = 2000;

// ------------------------------------------------------------------------------------------------ the examples

struct Example {
  std::string name;
  std::string mesh;  ///< beside the scene; empty: the standard cube
  std::vector<runtime::Plane> cuts;
  double time_ms = 0.0;
};

/// The pictures of the examples' own pages, with the default camera.
const std::vector<Example>& examples() {
  static const std::vector<Example> table{
      {"orange", "orange.ply", {{{0, 1, 0}, 0.0}}, 0.0},
      {"skin", "skin.ply", {{{0, 0, 1}, 0.35}}, 1000.0},
      {"metaballs", "", {{{0, 0, 1}, 0.85}, {{0, 1, 0}, 0.85}, {{1, 0, 0}, 0.85}}, 1500.0},
      {"sticks", "ball.obj", {{{0.1, 0.3, 1}, 0.3}}, 1000.0},
      {"metaballs_plus", "", {{{0, 0, 1}, 0.85}}, 1500.0},
      {"skull", "skull.ply", {{{1, 0, 0}, 0.0}}, 0.0},
      {"molecule", "haemoglobin.obj", {{{0, 0, 1}, 0.0}}, 1000.0},
      {"virion", "virion.ply", {{{0.8, 0, 0.6}, 0.011}}, 1000.0},
      {"mycoplasma", "mycoplasma.ply", {{{0.6, 0, 0.8}, 0.02}}, 0.0},
  };
  return table;
}

bool is_animated(std::string_view example) {
  return example != "orange" && example != "mycoplasma" && example != "skull";
}

/// In the order of the thesis' table 4.1.
const std::vector<std::pair<std::string, ThesisFigures>>& thesis_table() {
  static const std::vector<std::pair<std::string, ThesisFigures>> table{
      {"orange", {2008, 4.23, 3.25, 12, 139}},          {"skin", {1221, 10.23, 7.82, 13, 144}},
      {"metaballs", {4000, 2.31, 0.81, 35, 158}},       {"sticks", {1000, 1.21, 1.48, 22, 146}},
      {"metaballs_plus", {20000, 3.12, 0.57, 31, 147}},
  };
  return table;
}

// ------------------------------------------------------------------------------------------------ making cases

class Planner {
 public:
  explicit Planner(const PlanOptions& options) : options_(options) {}

  Plan take() { return std::move(plan_); }

  void boundaries();
  void sampling();
  void growth(bool whole_range);
  void code_forms();
  static void lighten(Case& made);
  void speed();
  void passes();
  void example_settings(const std::string& name);
  void thesis();
  void user_scenes();

 private:
  Case& add(const std::string& section, const std::string& series, const std::string& variant_name,
            std::optional<Parameter> parameter, const std::string& scene_key, std::function<SceneSource()> scene) {
    Case made;
    made.section = section;
    made.series = series;
    made.variant = variant_name;
    made.settings = variant(variant_name).settings;
    made.needs_grids = variant(variant_name).needs_grids;
    made.parameter = std::move(parameter);
    made.scene_key = scene_key;
    made.scene = std::move(scene);
    made.id = fmt::format("{}/{}/{}", section, scene_key, variant_name);
    if (made.settings.verdicts) {
      made.effort.settle_frames = 100;
      made.effort.settle_ms = options_.quick ? 300.0 : 6000.0;
    }
    if (options_.quick) {
      made.effort.builds = 1;
      made.effort.min_frames = 3;
      made.effort.frames_ms = 200.0;
      made.effort.probe_rounds = 3;
      made.effort.points = 4000;
      made.effort.error_size_px = {160, 90};
    }
    plan_.cases.push_back(std::move(made));
    return plan_.cases.back();
  }

  /// Every setting that says something about a scene.
  void all_settings(const std::string& section, const SceneSource& source, glm::uvec2 size_px) {
    for (const Variant& row : variants()) {
      if (row.settings.samples > 1 && options_.quick) continue;
      if (!row.settings.disabled_passes.empty() && options_.quick && options_.scenes.empty()) continue;
      Case& made = add(section, source.name, row.name, std::nullopt, source.name, [source] { return source; });
      made.size_px = size_px;
      if (&row != &variants().front()) made.effort.builds = 1;
    }
  }

  bool found(const std::string& name) {
    const auto source = example_scene(options_.examples, name);
    if (source) return true;
    const std::string path = (fs::path(options_.examples) / name / (name + ".voml")).string();
    plan_.missing.push_back({name, fmt::format("not there yet: no {}", path)});
    return false;
  }

  void grow(const std::string& series, const std::string& parameter, const std::vector<std::uint32_t>& values,
            const std::vector<std::string>& variant_names, const std::function<SceneSource(std::uint32_t)>& make) {
    for (const std::uint32_t value : values) {
      for (const std::string& name : variant_names) {
        Case& made = add("growth", series, name, Parameter{parameter, static_cast<double>(value)},
                         fmt::format("{} {}", series, value), [=] { return make(value); });
        made.effort.builds = 1;
        made.effort.points = std::min(made.effort.points, 5000u);
        made.effort.error_size_px = {};
      }
    }
  }

  const PlanOptions& options_;
  Plan plan_;
};

/// Displacement against resolution, for each way to store and to filter a grid.
void Planner::boundaries() {
  const std::vector<std::uint32_t> sizes = options_.quick
                                               ? std::vector<std::uint32_t>{16, 32, 64}
                                               : std::vector<std::uint32_t>{16, 24, 32, 48, 64, 96, 128, 192, 256};
  std::vector<std::shared_ptr<const Shape>> shapes{std::make_shared<const Shape>(sphere(surface_points))};
  if (!options_.quick) shapes.push_back(std::make_shared<const Shape>(torus(surface_points)));
  for (const auto& shape : shapes) {
    for (const std::uint32_t n : sizes) {
      for (const Variant& row : variants()) {
        const bool of_interest = row.needs_grids || row.name == variants().front().name ||
                                 (row.settings.codegen != Codegen::specialised && (n == 16 || n == 64 || n == 256));
        if (!of_interest) continue;
        Case& made = add("boundary", shape->name, row.name, Parameter{"resolution", static_cast<double>(n)},
                         fmt::format("{} {}", shape->name, n), [shape, n] { return grid_scene(*shape, n); });
        made.shape = shape;
        made.size_px = {512, 512};
        made.effort.builds = 1;
        made.effort.max_frames = 15;
        made.effort.frames_ms = 250.0;
        made.effort.points = 5000;
        made.effort.error_size_px = options_.quick ? glm::uvec2(128) : glm::uvec2(256);
      }
    }
  }
}

/// Colour error of a picture against its converged mean, and what the samples cost.
void Planner::sampling() {
  const std::uint32_t count = 1000;
  for (const std::uint32_t samples : {1u, 2u, 3u, 4u, 6u, 8u}) {
    if (options_.quick && samples > 4) continue;
    Case& made = add("samples", "samples", variants().front().name, Parameter{"samples", static_cast<double>(samples)},
                     "samples", [] {
                       SceneSource source = many_objects(count);
                       source.slice = runtime::Plane{{0.0, 0.0, 1.0}, 0.05};
                       return source;
                     });
    made.id = fmt::format("samples/objects {}/samples {}", count, samples);
    made.settings.samples = samples;
    made.size_px = {192, 192};
    made.effort.builds = 1;
    made.effort.points = 0;
    made.effort.probe_rounds = 0;
    made.effort.error_size_px = options_.quick ? glm::uvec2(64) : glm::uvec2(128);
    made.effort.truth_samples = 16;
  }
}

void Planner::growth(bool whole_range) {
  using Values = std::vector<std::uint32_t>;
  const bool quick = options_.quick;
  const std::vector<std::string> ours{"auto"};
  const std::vector<std::string> both = quick ? ours : std::vector<std::string>{"auto", "table"};
  grow("objects", "objects", quick ? Values{100, 1000, 10000} : Values{100, 1000, 10000, 100000, 1000000}, ours,
       many_objects);
  grow("tree depth", "decisions", quick ? Values{4, 16} : Values{1, 2, 4, 8, 16, 32, 64}, both,
       [](std::uint32_t depth) { return decision_tree(TreeForm::chain, Source::analytic, depth); });
  grow("embedding depth", "levels", quick ? Values{4, 16} : Values{1, 2, 4, 8, 16, 32, 64}, both, nested_objects);
  grow("atlas", "grids", quick ? Values{1, 8} : Values{1, 4, 16, 64}, ours,
       [](std::uint32_t count) { return many_grids(count, 64); });
  const std::vector<glm::uvec2> sizes =
      quick ? std::vector<glm::uvec2>{{320, 180}, {1280, 720}}
            : std::vector<glm::uvec2>{{160, 90}, {320, 180}, {640, 360}, {1280, 720}, {1920, 1080}, {2560, 1440}};
  for (const glm::uvec2& size : sizes) {
    const double pixels = static_cast<double>(size.x) * size.y;
    Case& made =
        add("growth", "picture", "auto", Parameter{"pixels", pixels}, "picture", [] { return many_objects(1000); });
    made.id = fmt::format("growth/picture {}x{}/specialised", size.x, size.y);
    made.size_px = size;
    made.effort.builds = 1;
    made.effort.points = 0;
    made.effort.probe_rounds = 0;
    made.effort.error_size_px = {};
  }
  if (!whole_range) return;
  grow("levels table", "levels", {128, 250}, {"table"}, nested_objects);
  grow("large atlas", "grids", {128, 256}, ours, [](std::uint32_t count) { return many_grids(count, 64); });
}

/// The table that a cost model of code forms needs: chains and full trees, analytic and grids, in each form.
void Planner::code_forms() {
  for (const TreeForm form : {TreeForm::chain, TreeForm::full}) {
    for (const Source source : {Source::analytic, Source::grid}) {
      const std::string series = fmt::format("{} {}", form == TreeForm::chain ? "chain" : "tree",
                                             source == Source::grid ? "grids" : "analytic");
      const std::vector<std::uint32_t> depths =
          form == TreeForm::full ? std::vector<std::uint32_t>{2, 4, 6} : std::vector<std::uint32_t>{6, 40};
      grow(series, form == TreeForm::full ? "levels" : "decisions", depths, {"specialised", "table"},
           [=](std::uint32_t depth) { return decision_tree(form, source, depth); });
    }
  }
  grow("empty", "regions", {1}, {"auto"}, [](std::uint32_t) { return empty_cube(); });
}

/// Nothing but frames as large as a screen.
void Planner::lighten(Case& made) {
  made.size_px = {1280, 720};
  made.effort.builds = 1;
  made.effort.points = made.effort.probe_rounds = 0;
  made.effort.error_size_px = {};
}

/// Every example from three views, against the table form and against a frame of one colour; growth; what passes save.
void Planner::speed() {
  Case& floor = add("speed", floor_series, "auto", std::nullopt, floor_series, [] {
    SceneSource source = empty_cube();
    source.slice = runtime::Plane{{0.0, 0.0, 1.0}, 0.0};
    return source;
  });
  lighten(floor);
  for (const char* name :
       {"orange", "skin", "metaballs", "metaballs_plus", "sticks", "molecule", "virion", "mycoplasma"}) {
    if (!found(name)) continue;
    for (const std::string_view view : {"whole", "cut", "zoomed"}) {
      if (options_.quick && view != "cut") continue;
      SceneSource source = *example_scene(options_.examples, name);
      source.name = fmt::format("{}, {}", name, view);
      if (view == "whole") source.cuts.clear();
      if (view == "zoomed") source.zoom = 8.0;
      if (view == "cut") plan_.starts.push_back(source);
      for (const char* form : {"auto", "camera swings", "time goes on", "table"}) {
        if (std::string_view(form) == "time goes on" && !is_animated(name)) continue;
        Case& made = add("speed", source.name, form, std::nullopt, source.name, [source] { return source; });
        const glm::uvec2 compared = made.effort.error_size_px;
        lighten(made);
        if (std::string_view(form) == "auto") made.effort.error_size_px = compared;
      }
      Case& surface = add("speed", source.name, "auto", std::nullopt, source.name, [source] { return source; });
      lighten(surface);
      surface.variant = surface_alone;
      surface.settings.surface_alone = true;
      surface.id += fmt::format(" {}", surface_alone);
    }
  }
  passes();
  const std::vector<std::string> ours{"auto"};
  grow("objects", "objects",
       options_.quick ? std::vector<std::uint32_t>{100, 10000}
                      : std::vector<std::uint32_t>{100, 1000, 10000, 100000, 1000000},
       ours, many_objects);
  grow("large snippet", "operations", {8000}, {"auto", "no tapes", "no shorten-tapes"}, large_snippet);
  grow("embedding depth", "levels", {1, 4, 12}, ours, nested_objects);
  grow("tree depth", "decisions", {4, 16, 64}, ours,
       [](std::uint32_t depth) { return decision_tree(TreeForm::chain, Source::analytic, depth); });
}

/// Each pass of a frame, and those of the compiler that divide its work, switched off alone, where the camera swings
/// and where time goes on.
void Planner::passes() {
  if (options_.quick) return;
  for (const char* name : {"orange", "skin", "molecule"}) {
    if (!found(name)) continue;
    SceneSource source = *example_scene(options_.examples, name);
    source.name = fmt::format("{}, cut", name);
    for (const char* motion : {"camera swings", "time goes on"}) {
      if (std::string_view(motion) == "time goes on" && !is_animated(name)) continue;
      std::vector<std::string> off{""};
      for (const auto& pass : runtime::frame_pass_names()) off.emplace_back(pass.name);
      off.insert(off.end(), {"stages", "sink-answers"});
      for (const std::string& pass : off) {
        Case& made = add("passes", fmt::format("{}, {}", source.name, motion), motion, std::nullopt,
                         source.name + ", passes", [source] { return source; });
        lighten(made);
        if (pass.empty()) continue;
        made.variant = "no " + pass;
        made.settings.disabled_passes = {pass};
        made.id += " " + made.variant;
      }
    }
  }
}

void Planner::example_settings(const std::string& name) {
  if (!found(name)) return;
  const SceneSource source = *example_scene(options_.examples, name);
  all_settings("scene", source, {640, 360});
}

/// Table 4.1 of the thesis: its scenes, and its own way of evaluating as the baseline.
void Planner::thesis() {
  for (const auto& [name, figures] : thesis_table()) {
    if (!found(name)) continue;
    const SceneSource source = *example_scene(options_.examples, name);
    for (const char* form : {"auto", "table", "thesis"}) {
      Case& made = add("thesis", name, form, std::nullopt, name, [source] { return source; });
      made.thesis = figures;
      made.size_px = options_.quick ? glm::uvec2(640, 360) : glm::uvec2(1280, 720);
      made.effort.frames_ms = options_.quick ? 300.0 : 3000.0;
      if (options_.quick) made.effort.probe_rounds = 0;
    }
  }
}

void Planner::user_scenes() {
  for (const SceneSource& source : options_.scenes) all_settings("scene", source, options_.size_px);
}

}  // namespace

const std::vector<Variant>& variants() {
  static const std::vector<Variant> table = [] {
    std::vector<Variant> rows{
        {"auto", {}, false},
        {"specialised", {.codegen = Codegen::specialised}, false},
        {"table", {.codegen = Codegen::table}, false},
        {"thesis", {.codegen = Codegen::thesis}, false},
        {"r16f", {.atlas = TexelFormat::r16f}, true},
        {"snorm16", {.atlas = TexelFormat::snorm16}, true},
        {"snorm8", {.atlas = TexelFormat::snorm8}, true},
        {"filter shader", {.filter = Filter::shader}, true},
        {"filter tricubic", {.filter = Filter::tricubic}, true},
        {"samples 2", {.samples = 2}, false},
        {"samples 4", {.samples = 4}, false},
        {"camera swings", {.motion = Motion::camera, .verdicts = true}, false},
        {"time goes on", {.motion = Motion::time, .verdicts = true}, false},
    };
    for (const compiler::PassInfo& pass : compiler::pass_names()) {
      rows.push_back({fmt::format("no {}", pass.name), {.disabled_passes = {std::string(pass.name)}}, false});
    }
    rows.push_back({"no pixel-list", {.disabled_passes = {"pixel-list"}}, false});
    return rows;
  }();
  return table;
}

const Variant& variant(const std::string& name) { return *std::ranges::find(variants(), name, &Variant::name); }

std::string name_of(Codegen codegen) {
  constexpr std::array names{"specialised", "table", "thesis", "auto"};
  return names[static_cast<std::size_t>(codegen)];
}

std::string name_of(TexelFormat format) {
  switch (format) {
    case TexelFormat::r32f:
      return "r32f";
    case TexelFormat::r16f:
      return "r16f";
    case TexelFormat::snorm16:
      return "snorm16";
    case TexelFormat::snorm8:
      return "snorm8";
    case TexelFormat::unorm8:
      return "unorm8";
    case TexelFormat::rgba16f:
      return "rgba16f";
  }
  return {};
}

std::string name_of(Filter filter) {
  constexpr std::array names{"hardware", "shader", "tricubic"};
  return names[static_cast<std::size_t>(filter)];
}

std::string name_of(Motion motion) {
  constexpr std::array names{"camera", "time", "none"};
  return names[static_cast<std::size_t>(motion)];
}

const std::vector<SetName>& set_names() {
  static const std::vector<SetName> names{
      {"standard", "boundaries against resolution, samples, growth, and the orange and the sticks with every setting"},
      {"thesis", "the scenes of the thesis' table 4.1, beside its figures and its way of evaluating"},
      {"stress", "figures where float32, drivers and data structures are pushed, each with its bound"},
      {"speed",
       "every example whole, cut and zoomed, against the table form and a frame of one colour; passes of a frame; "
       "growth"},
      {"growth", "growth to the limits, and the forms of code against each other"},
  };
  return names;
}

std::optional<SceneSource> example_scene(const std::string& folder, const std::string& name) {
  const auto example = std::ranges::find(examples(), name, &Example::name);
  if (example == examples().end()) return std::nullopt;
  const fs::path place = fs::path(folder) / name;
  std::error_code ignored;
  if (!fs::exists(place / (name + ".voml"), ignored)) return std::nullopt;
  SceneSource source;
  source.name = name;
  source.path = (place / (name + ".voml")).string();
  source.files = disk_files();
  if (!example->mesh.empty()) source.mesh_path = (place / example->mesh).string();
  source.cuts = example->cuts;
  source.time_ms = example->time_ms;
  return source;
}

Plan make_plan(const PlanOptions& options) {
  Planner planner(options);
  if (!options.scenes.empty()) {
    planner.user_scenes();
  } else if (options.set == "thesis") {
    planner.thesis();
  } else if (options.set == "speed") {
    planner.speed();
  } else if (options.set == "growth") {
    planner.growth(true);
    planner.code_forms();
  } else if (options.set == "standard") {
    planner.boundaries();
    planner.sampling();
    planner.growth(false);
    planner.example_settings("orange");
    if (!options.quick) planner.example_settings("sticks");
  }
  return planner.take();
}

}  // namespace dmvv::bench
