// The options that say what a picture shows, shared by the commands that draw.
#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/options.h"
#include "compiler/compile.h"
#include "runtime/view/view.h"

namespace dmvv::cli {

struct ViewOptions {
  std::string size = "1280x720";
  std::string camera;
  std::string mesh;
  std::vector<std::string> cuts;
  std::string slice;
  std::string shading = "lit";
  std::uint32_t samples = 1;
};

/// Options that exclude sections.
struct SeenOptions {
  CLI::Option *camera, *mesh, *cut;
};
/// --size, --camera, --mesh, --cut.
SeenOptions add_seen_options(CLI::App& command, ViewOptions& options);
/// Those, and --slice, --shading, --samples.
void add_view_options(CLI::App& command, ViewOptions& options);

/// What the texts of the options say, or wrong usage. Without a mesh and a slice, rays are cast. The camera waits for
/// what it frames.
runtime::View parse_view(const ViewOptions& options);

/// Reads the support mesh by way of `files`, if there is one, and sets the camera that frames it unless one was chosen.
/// Mistakes are printed and stop the command.
void place_camera(runtime::View& view, const ViewOptions& options, const ReadFile& files, Context& context,
                  Diagnostics& diagnostics);

/// The kernels that draw the view.
compiler::Source kernels_for(const runtime::View& view);

/// Sets the camera of a picture by rays, unless one was chosen: it frames all that the scene holds.
void frame_content(runtime::View& view, const ViewOptions& options, const voml::Bounds& content);

/// Says that cutting a mesh that is not closed may show leaks.
void warn_of_edges(const voml::EdgeFaults& edges, const ViewOptions& options, const Context& context);

}  // namespace dmvv::cli
