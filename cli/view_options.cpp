#include "cli/view_options.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace dmvv::cli {

SeenOptions add_seen_options(CLI::App& command, ViewOptions& options) {
  command.add_option("--size", options.size, fmt::format("Width and height in pixels; default {}", options.size))
      ->type_name("WxH");
  auto* camera = command
                     .add_option("--camera", options.camera,
                                 "\"eye X Y Z look X Y Z fov DEGREES\", \"up X Y Z\" optional; default: a camera that "
                                 "frames all that is there")
                     ->type_name("TEXT");
  auto* mesh = command
                   .add_option("--mesh", options.mesh,
                               "Draw the points of a support mesh only (OBJ, PLY, STL, OFF), instead of what rays meet")
                   ->type_name("FILE");
  auto* cut = command.add_option("--cut", options.cuts, "\"NX NY NZ D\" takes away n.x > D (repeatable)")
                  ->type_name("PLANE")
                  ->allow_extra_args(false);
  return {camera, mesh, cut};
}

void add_view_options(CLI::App& command, ViewOptions& options) {
  const SeenOptions seen = add_seen_options(command, options);
  command.add_option("--slice", options.slice, "Draw the section of a plane instead: \"z=0\" or \"NX NY NZ D\"")
      ->type_name("PLANE")
      ->excludes(seen.camera)
      ->excludes(seen.mesh)
      ->excludes(seen.cut);
  command.add_option("--shading", options.shading, "none or lit (default; slices are never lit)")->type_name("WORD");
  command.add_option("--samples", options.samples, "Samples along each axis of a pixel, 1 to 16; default 1")
      ->type_name("N")
      ->check(CLI::Range(1, 16));
}

runtime::View parse_view(const ViewOptions& options) {
  runtime::View view;
  view.size_px = must_parse("--size", runtime::parse_size(options.size));
  if (!options.camera.empty()) view.camera = must_parse("--camera", runtime::parse_camera(options.camera));
  for (const std::string& cut : options.cuts) view.cuts.push_back(must_parse("--cut", runtime::parse_plane(cut)));
  if (!options.slice.empty()) view.slice = must_parse("--slice", runtime::parse_slice(options.slice));
  if (options.shading != "none" && options.shading != "lit") {
    fail_usage(fmt::format("--shading: unknown word '{}'", options.shading), {"use none or lit"});
  }
  view.shading = options.shading == "lit" ? runtime::Shading::lit : runtime::Shading::none;
  view.samples = options.samples;
  view.rays = options.mesh.empty() && !view.slice;
  return view;
}

namespace {

/// How far off a point of a drawn surface may be, for coordinates up to 1 (spec/accuracy.md).
constexpr double surface_error = 5e-7;

/// By the pixel at the point that the camera looks at.
void warn_of_deep_zoom(const runtime::View& view, const Context& context) {
  if (view.slice || context.quiet) return;
  const double distance = glm::length(view.camera.look - view.camera.eye);
  const double height = 2.0 * distance * std::tan(view.camera.fov_deg * std::numbers::pi / 360.0);
  const double pixel = height / (double(view.size_px.y) * view.samples);
  if (!(pixel < surface_error)) return;
  print_warning(
      fmt::format("a pixel covers {:.2g} where the camera looks, but float32 tells points of a surface apart "
                  "to {:.2g} only: the picture shows steps",
                  pixel, surface_error));
}

}  // namespace

void place_camera(runtime::View& view, const ViewOptions& options, const ReadFile& files, Context& context,
                  Diagnostics& diagnostics) {
  if (!options.mesh.empty())
    view.mesh = std::make_shared<const voml::Mesh>(read_mesh(options.mesh, context, diagnostics, files));
  if (options.camera.empty() && !view.slice && !view.rays)
    view.camera = runtime::default_camera(voml::bounds(*runtime::support_mesh(view)), view.size_px, view.cuts);
  warn_of_deep_zoom(view, context);
}

compiler::Source kernels_for(const runtime::View& view) {
  return view.rays ? compiler::Source::rays : compiler::Source::surface;
}

void frame_content(runtime::View& view, const ViewOptions& options, const voml::Bounds& content) {
  if (view.rays && options.camera.empty()) view.camera = runtime::default_camera(content, view.size_px, view.cuts);
}

void warn_of_edges(const voml::EdgeFaults& edges, const ViewOptions& options, const Context& context) {
  if (context.quiet) return;
  for (const std::string& fault : voml::describe(edges)) {
    print_warning(fmt::format("'{}': {}; the caps of its cuts may leak", options.mesh, fault));
  }
}

}  // namespace dmvv::cli
