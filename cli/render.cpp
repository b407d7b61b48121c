// dmvv render SCENE -o PICTURE: one picture, and on request region numbers and depth beside it.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "base/files.h"
#include "cli/commands.h"
#include "cli/outputs.h"
#include "cli/view_options.h"

namespace dmvv::cli {
namespace {

struct RenderOptions {
  SceneOptions scene;
  DeviceChoice device;
  CodegenChoice codegen;
  ViewOptions view;
  double time_ms = 0;
  std::string picture;
  std::vector<std::string> aovs;
};

/// A picture beside the picture.
struct AovKind {
  std::string_view name;
  std::vector<std::string_view> endings;
  bool runtime::View::*wanted;
  Result<void> (*write)(const std::string& path, const runtime::Picture& picture);
};
const std::array<AovKind, 4>& aov_kinds() {
  static const std::array<AovKind, 4> kinds{{
      {"region", {".exr", ".png", ".tif", ".tiff"}, &runtime::View::want_regions, runtime::write_regions},
      {"depth", {".exr"}, &runtime::View::want_depth, runtime::write_depth},
      {"normal", {".exr", ".png", ".tif", ".tiff"}, &runtime::View::want_normals, runtime::write_normals},
      {"doubt", {".exr", ".png", ".tif", ".tiff"}, &runtime::View::want_doubt, runtime::write_doubt},
  }};
  return kinds;
}
/// Of each kind; empty where not asked for.
using AovPaths = std::array<std::string, 4>;

/// Where the next word begins: a comma within a name stays.
std::size_t next_aov(const std::string& words) {
  std::size_t comma = std::string::npos;
  for (const AovKind& kind : aov_kinds()) comma = std::min(comma, words.find(fmt::format(",{}=", kind.name)));
  return comma;
}

/// Reads "region=FILE", "depth=FILE", ..., and several with commas between.
AovPaths parse_aovs(const std::vector<std::string>& words) {
  AovPaths paths;
  for (std::string rest : words) {
    while (!rest.empty()) {
      const std::size_t comma = next_aov(rest);
      const std::string word = rest.substr(0, comma);
      rest = comma == std::string::npos ? "" : rest.substr(comma + 1);
      const std::size_t equals = word.find('=');
      const auto kind = std::ranges::find(aov_kinds(), std::string_view(word).substr(0, equals), &AovKind::name);
      if (kind == aov_kinds().end() || equals == std::string::npos || equals + 1 == word.size()) {
        fail_usage(fmt::format("--aov: cannot read '{}'", word),
                   {"write region=FILE, depth=FILE, normal=FILE or doubt=FILE"});
      }
      std::string& path = paths[static_cast<std::size_t>(kind - aov_kinds().begin())];
      if (!path.empty()) fail_usage(fmt::format("--aov: {} is asked for twice", kind->name));
      path = word.substr(equals + 1);
    }
  }
  return paths;
}

/// What is asked for, as far as such a view has it.
void want_aovs(const AovPaths& aovs, runtime::View& view) {
  for (std::size_t i = 0; i < aovs.size(); ++i) view.*aov_kinds()[i].wanted = !aovs[i].empty();
  if (view.want_normals && view.slice) fail_usage("--aov normal: a section has no normals", {"leave --slice out"});
  if (view.want_doubt && !view.rays)
    fail_usage("--aov doubt: only rays can miss something", {"leave --mesh and --slice out"});
}

std::string legend_json(std::vector<compiler::RegionInfo> regions) {
  std::ranges::sort(regions, {}, &compiler::RegionInfo::number);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const compiler::RegionInfo& region : regions) {
    if (region.number == 0) continue;  // empty: never in a picture
    nlohmann::ordered_json entry{
        {"number", region.number}, {"object", region.object}, {"region", region.region}, {"kind", region.kind}};
    if (region.kind == "color") {
      entry["rgb"] = {region.rgb.r, region.rgb.g, region.rgb.b};
    } else {
      entry["rgb"] = nullptr;
    }
    list.push_back(std::move(entry));
  }
  const nlohmann::ordered_json legend{{"regions", std::move(list)}};
  return legend.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

void announce(Outputs& outputs, const RenderOptions& options, const AovPaths& aovs) {
  outputs.announce(options.picture, {".png", ".tif", ".tiff", ".exr"});
  for (std::size_t i = 0; i < aovs.size(); ++i) {
    if (!aovs[i].empty()) outputs.announce(aovs[i], aov_kinds()[i].endings);
  }
  if (!aovs.front().empty()) outputs.announce(with_ending(aovs.front(), ".json"));
}

void write(Outputs& outputs, const RenderOptions& options, const AovPaths& aovs, const runtime::Picture& picture,
           const std::vector<compiler::RegionInfo>& regions) {
  outputs.write(options.picture, [&](const std::string& path) { return runtime::write_picture(path, picture); });
  for (std::size_t i = 0; i < aovs.size(); ++i) {
    if (aovs[i].empty()) continue;
    outputs.write(aovs[i], [&](const std::string& path) { return aov_kinds()[i].write(path, picture); });
  }
  if (!aovs.front().empty()) outputs.write_bytes(with_ending(aovs.front(), ".json"), legend_json(regions));
  outputs.commit();
}

/// "; 0.02 % of its rays may miss something thin", or nothing.
std::string doubt_of(const runtime::Picture& picture, const runtime::View& view) {
  if (picture.doubtful_rays == 0) return {};
  const double rays = double(view.size_px.x) * view.size_px.y * view.samples * view.samples;
  return fmt::format("; {:.2g} % of its rays may miss something thin",
                     100.0 * static_cast<double>(picture.doubtful_rays) / rays);
}

/// A newcomer's puzzle: a scene that ends within the mesh leaves nothing on the mesh to be seen. Says what helps.
void warn_of_nothing(const runtime::Picture& picture, const runtime::View& view, const voml::Bounds& content,
                     const Context& context) {
  if (context.quiet || runtime::shows_something(picture)) return;
  if (view.rays) {
    return print_warning(fmt::format(
        "nothing to see: no ray meets anything; all that the scene holds lies between ({:.3g}, {:.3g}, {:.3g}) and "
        "({:.3g}, {:.3g}, {:.3g}): look there (--camera), or cut less away",
        content.lo.x, content.lo.y, content.lo.z, content.hi.x, content.hi.y, content.hi.z));
  }
  if (view.slice) return print_warning("nothing to see: the scene is empty on this section");
  print_warning(
      "nothing to see: the scene is empty wherever the support mesh is seen; draw without it, or make one of the "
      "scene's own surface (dmvv mesh)");
}

/// Goes near to what the picture shows: content ends within boxes that it does not fill. A small picture tells where it
/// is. Media are seen where no ray ends; then their boxes are framed.
Result<void> frame_what_is_seen(runtime::View& view, const compiler::Program& program, runtime::Evaluator& evaluator) {
  if (program.find_kernel(compiler::media_kernel.name) != nullptr) return {};
  runtime::View small = view;
  small.size_px = glm::max(view.size_px / 8u, glm::uvec2(1));
  small.samples = 1;
  small.shading = runtime::Shading::none;
  small.want_positions = true;
  small.want_regions = small.want_depth = small.want_normals = small.want_doubt = false;
  const auto picture = evaluator.render(small);
  if (!picture) return tl::unexpected(picture.error());
  const double depth = glm::length(view.camera.look - view.camera.eye);
  const double pixel = 2.0 * depth * std::tan(view.camera.fov_deg * std::numbers::pi / 360.0) / small.size_px.y;
  view.camera = runtime::framing(view.camera, view.size_px, picture->positions, pixel);
  return {};
}

void warn_of_eye(const runtime::Picture& picture, const Context& context) {
  if (context.quiet || !picture.eye_within) return;
  print_warning(
      "the eye stands within something opaque, and sees nothing else: move it (--camera), or cut it free (--cut)");
}

int render(const RenderOptions& options, Context& context) {
  // Everything that can be refused without the scene comes first.
  runtime::View view = parse_view(options.view);
  view.time_ms = options.time_ms;
  const AovPaths aovs = parse_aovs(options.aovs);
  if (options.picture.ends_with(".png")) view.colors = runtime::Colors::bytes;
  compiler::CompileOptions form = compile_options(options.codegen);
  view.disabled_passes = form.disabled_passes;
  view.rays = view.rays && form.codegen != compiler::Codegen::thesis;  // which draws the cube's faces
  form.rays = view.rays;
  want_aovs(aovs, view);
  Outputs outputs;
  announce(outputs, options, aovs);

  session::Session session = make_session(options.device, context);
  Diagnostics diagnostics(options.scene.strict);
  voml::Scene scene = must(session.read(scene_file(options.scene), diagnostics), diagnostics, context);
  place_camera(view, options.view, disk_files(), context, diagnostics);
  if (!view.rays) session.prepare_surface(view);
  runtime::Timings timings;
  auto [program, evaluator] = load(session, std::move(scene), form, kernels_for(view), context, diagnostics, &timings);
  frame_content(view, options.view, program.content);
  if (view.rays && options.view.camera.empty()) must(frame_what_is_seen(view, program, evaluator));
  const runtime::Picture picture = must(evaluator.render(view, &timings));
  context.stopwatch.lap(timings, "other");

  warn_of_edges(picture.edges, options.view, context);
  warn_of_eye(picture, context);
  warn_of_nothing(picture, view, program.content, context);
  if (const int exit_code = exit_code_of(session.validation_messages()); exit_code != exit_done) return exit_code;
  write(outputs, options, aovs, picture, program.regions);
  context.stopwatch.lap("encode");
  if (!context.quiet) {
    print_result(fmt::format("{}: {}x{}, {:.2f} s on {}{}\n", options.picture, picture.size_px.x, picture.size_px.y,
                             context.stopwatch.seconds(), must(session.device()).info().name, doubt_of(picture, view)));
  }
  return exit_done;
}

}  // namespace

void add_render(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App& command = *app.add_subcommand("render", "Draw a picture of a scene");
  add_scene_options(command, options->scene);
  command.add_option("-o,--output", options->picture, "Picture: .png, .tif or .exr")->required()->type_name("PICTURE");
  add_view_options(command, options->view);
  command
      .add_option(
          "--aov", options->aovs,
          "More pictures: region=FILE (numbers, with a .json legend beside it), depth=FILE (.exr), normal=FILE, "
          "doubt=FILE (where a ray may miss something thin)")
      ->type_name("KIND=FILE")
      ->allow_extra_args(false);
  add_time_option(command, options->time_ms);
  add_codegen_options(command, options->codegen);
  add_device_options(command, options->device);
  add_common_options(command, invocation.context);
  command.footer(
      "Examples:  dmvv render orange.voml -o half.png --cut \"0 0 1 0\" --camera \"eye 3 2 4 look 0 0 0 fov 30\"\n"
      "           dmvv render orange.voml -o section.png --slice z=0 --aov region=ids.exr");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return render(*options, context); };
  });
}

}  // namespace dmvv::cli
