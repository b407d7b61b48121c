// What is measured: a table of cases. Pure; nothing is read or run here.
#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/shapes.h"
#include "bench/source.h"
#include "compiler/compile.h"

namespace dmvv::bench {

/// The series of the section "speed" that is a frame of one colour, all of it in the cube but for the margins.
inline constexpr const char* floor_series = "one colour";
inline constexpr const char* surface_alone = "surface alone";

/// What changes from one timed frame to the next.
enum class Motion : std::uint8_t {
  camera,  ///< the camera swings around what it looks at: each frame shows other points of the surface
  time,    ///< only time goes on: what the camera sees of the mesh is kept
  none,    ///< nothing: frames are drawn anew all the same
};

/// One way to compile and draw a scene.
struct Settings {
  compiler::Codegen codegen = compiler::Codegen::automatic;
  compiler::TexelFormat atlas = compiler::TexelFormat::r32f;
  compiler::Filter filter = compiler::Filter::hardware;
  std::uint32_t samples = 1;  ///< per pixel along each axis
  Motion motion = Motion::none;
  bool verdicts = false;  ///< what can be proven between frames, is
  bool surface_alone =
      false;  ///< the support mesh and the cuts, holding one region: what a frame takes if evaluating is free
  std::vector<std::string> disabled_passes{};  ///< of compiler::pass_names() and runtime::frame_pass_names()
};

/// A row of the table of settings. The first is what users get.
struct Variant {
  std::string name;
  Settings settings;
  bool needs_grids = false;  ///< says nothing about a scene without distance grids
};
/// Every setting that is compared, each differing from the first in one thing.
const std::vector<Variant>& variants();
const Variant& variant(const std::string& name);

std::string name_of(compiler::Codegen codegen);
std::string name_of(compiler::TexelFormat format);
std::string name_of(compiler::Filter filter);
std::string name_of(Motion motion);

/// How much is spent on one case.
struct Effort {
  std::uint32_t builds = 3;  ///< from text to the first picture, each from nothing
  std::uint32_t min_frames = 5;
  std::uint32_t max_frames = 25;
  std::uint32_t settle_frames = 0;  ///< drawn before any is timed, while verdicts are found,
  double settle_ms = 0.0;           ///< or for so long
  double frames_ms = 1000.0;        ///< after which no further frame or probe is begun, once there are enough to tell
  std::uint32_t probe_rounds = 5;   ///< of the cost of a point; 0: not measured
  std::uint32_t points = 20000;     ///< compared with the reference, spread over the support mesh's box
  glm::uvec2 error_size_px{320, 180};  ///< of the picture compared with the reference; 0: none
  std::uint32_t truth_samples = 0;  ///< > 0: colours are compared with the mean of this many reference samples squared
};

struct Parameter {
  std::string name;  ///< "resolution", "objects", ...
  double value;
};

/// Figures of the thesis (table 4.1) for a scene.
struct ThesisFigures {
  std::uint32_t objects;
  double build_s_laptop, build_s_desktop;
  double fps_laptop, fps_desktop;
};

struct Case {
  std::string id;       ///< unique, stable: what results are compared by
  std::string section;  ///< "boundary", "samples", "scene", "growth", "thesis", "speed", "passes"
  std::string series;   ///< cases that differ in their parameter alone
  std::string variant;
  Settings settings;
  bool needs_grids = false;  ///< left out where the scene has none
  std::optional<Parameter> parameter;
  std::string scene_key;  ///< cases with the same key show the same scene; they stand together
  std::function<SceneSource()> scene;
  std::shared_ptr<const Shape> shape;  ///< the truth, where the scene shows a shape: displacement is measured
  std::optional<ThesisFigures> thesis;
  glm::uvec2 size_px{640, 360};  ///< of the frames that are timed
  Effort effort;
};

/// A scene that a set names and that is not there.
struct Missing {
  std::string scene;
  std::string reason;
};

struct Plan {
  std::vector<Case> cases;
  std::vector<SceneSource> starts;  ///< what a user waits for is measured as well
  std::vector<Missing> missing;
};

struct PlanOptions {
  std::string set = "standard";       ///< of set_names(); ignored if there are scenes
  bool quick = false;                 ///< fewer cases, less effort: some 30 s
  std::string examples{};             ///< folder with orange/orange.voml and so on, assets made
  std::vector<SceneSource> scenes{};  ///< of the user: measured with every setting that applies
  glm::uvec2 size_px{640, 360};       ///< of the frames of `scenes`
};

/// "standard", "thesis", "stress", "speed", "growth", each with a sentence.
struct SetName {
  std::string name;
  std::string what;
};
const std::vector<SetName>& set_names();

/// The cases of a set, those of a scene together. `set` must be one of set_names().
Plan make_plan(const PlanOptions& options);

/// The examples that the plan knows how to look at, by name: folder, file, support mesh, cuts, time.
/// Empty if `name` is none of them.
std::optional<SceneSource> example_scene(const std::string& folder, const std::string& name);

}  // namespace dmvv::bench
