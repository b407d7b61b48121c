// dmvv sdf MESH -o FILE.lxn: a distance grid from a triangle mesh.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>

#include "authoring/distance_grid.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/outputs.h"
#include "cli/ply.h"
#include "voml/grid.h"

namespace dmvv::cli {
namespace {

struct SdfOptions {
  std::string mesh;
  std::string grid;
  std::string fitted_mesh;
  bool no_fit = false;
  bool strict = false;
  authoring::GridOptions grid_options;
};

/// A line that counts up on a terminal; nothing anywhere else.
std::function<void(double)> progress_line(const Context& context) {
  if (context.quiet || !isatty(STDERR_FILENO)) return {};
  return [last = -1](double done) mutable {
    const int percent = static_cast<int>(100.0 * std::clamp(done, 0.0, 1.0));
    if (percent == last) return;
    last = percent;
    std::fputs(fmt::format("\r{:3} %{}", percent, percent == 100 ? "\r     \r" : "").c_str(), stderr);
  };
}

voml::Mesh fitted(voml::Mesh mesh, const authoring::GridReport& report) {
  for (glm::dvec3& p : mesh.positions) p = report.cube_from_mesh_scale * p + report.cube_from_mesh_offset;
  return mesh;
}

int sdf(const SdfOptions& options, Context& context) {
  Outputs outputs;
  outputs.announce(options.grid, {".lxn"});
  if (!options.fitted_mesh.empty()) outputs.announce(options.fitted_mesh, {".ply"});

  Diagnostics diagnostics(options.strict);
  voml::Mesh mesh = read_mesh(options.mesh, context, diagnostics);
  print_diagnostics(diagnostics, context);
  authoring::GridOptions grid_options = options.grid_options;
  grid_options.fit = !options.no_fit;
  authoring::GridReport report;
  const voml::Grid grid = must(authoring::distance_grid(mesh, grid_options, report, progress_line(context)));
  context.stopwatch.lap("distances");
  if (report.open_edges != 0 && !context.quiet) {
    print_warning(fmt::format("'{}' is not closed: {}; the sign near them is the winding number's guess", options.mesh,
                              plural(report.open_edges, "open edge")));
  }

  outputs.write_bytes(options.grid, voml::write_lxn(grid));
  if (!options.fitted_mesh.empty()) {
    outputs.write_bytes(options.fitted_mesh, write_ply(fitted(std::move(mesh), report)));
  }
  outputs.commit();
  context.stopwatch.lap("write");
  if (!context.quiet) {
    const auto [least, greatest] = std::ranges::minmax(grid.values);
    print_result(fmt::format("{}: {} x {} x {} samples, values {:.4g} to {:.4g}, {:.2f} s\n", options.grid, grid.size.x,
                             grid.size.y, grid.size.z, least, greatest, context.stopwatch.seconds()));
  }
  return exit_done;
}

}  // namespace

void add_sdf(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<SdfOptions>();
  CLI::App& command = *app.add_subcommand("sdf", "Make a distance grid (LXN) from a triangle mesh");
  command.add_option("MESH", options->mesh, "OBJ, PLY, STL or OFF file")->required()->type_name("");
  command.add_option("-o,--output", options->grid, "Distance grid: .lxn")->required()->type_name("FILE");
  command
      .add_option("--resolution", options->grid_options.resolution,
                  "Samples along the longest side, 4 to 512; default 64")
      ->type_name("N")
      ->check(CLI::Range(4, 512));
  command
      .add_option("--padding", options->grid_options.padding,
                  "Empty border around the mesh, a share of its longest side, 0 to 1; default 0.05")
      ->type_name("SHARE")
      ->check(CLI::Range(0.0, 1.0));
  command.add_flag("--no-fit", options->no_fit, "Keep the mesh's coordinates instead of fitting it into the cube");
  command.add_option("--write-mesh", options->fitted_mesh, "Also write the mesh as it was fitted: .ply")
      ->type_name("FILE");
  command.add_option("--threads", options->grid_options.threads, "Threads; default: one a core")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  command.add_flag("--strict", options->strict, "Treat warnings as errors");
  add_common_options(command, invocation.context);
  command.footer("Example:  dmvv sdf skull.ply -o skull.lxn --resolution 128 --write-mesh skull_fitted.ply");
  command.callback(
      [&invocation, options] { invocation.command = [options](Context& context) { return sdf(*options, context); }; });
}

}  // namespace dmvv::cli
