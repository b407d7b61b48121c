// dmvv sdf: a distance grid from a triangle mesh, or from an SDF of a scene.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <functional>
#include <memory>
#include <optional>

#include "authoring/bake.h"
#include "authoring/distance_grid.h"
#include "authoring/grid_check.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/outputs.h"
#include "cli/ply.h"
#include "cli/progress.h"
#include "voml/assets/grid.h"

namespace dmvv::cli {
namespace {

struct SdfOptions {
  std::string mesh;
  SceneOptions scene;  ///< --from
  std::string sdf;
  double time_ms = 0.0;
  bool distance = false;
  std::string grid;
  std::string fitted_mesh;
  bool no_fit = false;
  bool check = false;
  authoring::GridOptions grid_options;
  std::vector<std::string> given;  ///< options that belong to one of the two sources
};

/// A bar on a terminal, gone when the last copy of the function is.
authoring::Progress progress_bar(const Context& context) {
  const auto bar = std::make_shared<std::optional<ProgressBar>>();
  return [bar, quiet = context.quiet](std::size_t done, std::size_t total) {
    if (!*bar) bar->emplace("slices", total, 0, quiet);
    (*bar)->advance_to(done);
  };
}

voml::Mesh fitted(voml::Mesh mesh, const authoring::GridReport& report) {
  for (glm::dvec3& p : mesh.positions) p = report.cube_from_mesh_scale * p + report.cube_from_mesh_offset;
  return mesh;
}

// ---- what is told ----

std::string place(const glm::dvec3& p) { return fmt::format("({:.4f} {:.4f} {:.4f})", p.x, p.y, p.z); }

std::string length(double cube_units, double voxel) {
  return fmt::format("{:.3g} ({:.3g} voxel)", cube_units, cube_units / voxel);
}

/// "0 %", "0.01 %", "3.2 %", "100 %": of a share that was counted.
std::string percent(double share) {
  const double hundredths = 100.0 * share;
  return hundredths == 0.0 || hundredths >= 99.95 ? fmt::format("{:.0f} %", hundredths)
                                                  : fmt::format("{:.{}f} %", hundredths, hundredths < 1.0 ? 2 : 1);
}

/// Of lengths; or, with `voxel` 0, of values that are none.
std::string errors_line(std::string_view name, const authoring::Errors& errors, double voxel) {
  if (errors.points == 0) return fmt::format("  {:<16} no point found\n", name);
  const auto text = [&](double error) { return voxel > 0.0 ? length(error, voxel) : fmt::format("{:.3g}", error); };
  return fmt::format("  {:<16} max {} at {}, RMS {}; {} points\n", name, text(errors.greatest), place(errors.where),
                     text(errors.root_mean_square), errors.points);
}

std::string check_text(const authoring::GridCheck& check, bool values_are_lengths, const std::string& source) {
  const double voxel_of_values = values_are_lengths ? check.voxel : 0.0;
  std::string text = fmt::format("check against {}; a voxel is {:.4g}\n", source, check.voxel);
  text += errors_line("on the surface", check.surface, check.voxel);
  if (check.samples) text += errors_line("at samples", *check.samples, voxel_of_values);
  if (check.between) text += errors_line("between samples", *check.between, voxel_of_values);
  text += fmt::format("  {:<16} {} of {} points", "wrong side", check.wrong_side.points, check.side_points);
  if (check.wrong_side.points != 0) {
    text += fmt::format(", the farthest {} from the surface at {}", length(check.wrong_side.greatest, check.voxel),
                        place(check.wrong_side.where));
  }
  text += '\n';
  text += fmt::format("  {:<16} {} of the surface", "boundary lost", percent(check.boundary_lost));
  if (check.resolution_needed) {
    text += fmt::format(", where it is thinner than a voxel; {}",
                        authoring::resolution_needed_text(*check.resolution_needed));
  }
  text += '\n';
  if (check.bounding_nothing > 0.0) {
    text += fmt::format("  {} of the mesh's area bounds nothing: both its sides are solid, or neither\n",
                        percent(check.bounding_nothing));
  }
  return text;
}

std::string grid_text(const SdfOptions& options, const voml::Grid& grid, const Context& context) {
  const auto [least, greatest] = std::ranges::minmax(grid.values);
  return fmt::format("{}: {} x {} x {} samples, values {:.4g} to {:.4g}, {:.2f} s\n", options.grid, grid.size.x,
                     grid.size.y, grid.size.z, least, greatest, context.stopwatch.seconds());
}

/// A mesh that is not closed has an inside all the same: how much tells whether it is the one that was meant.
void warn_of_edges(const std::string& path, const voml::EdgeFaults& edges, const voml::Grid& grid) {
  for (const std::string& line : voml::describe(edges)) print_warning(fmt::format("'{}': {}", path, line));
  if (edges.count() == edges.crowded.count) return;  // winding numbers are whole, whatever touches
  const auto inside = static_cast<double>(std::ranges::count_if(grid.values, [](float value) { return value < 0.0f; }));
  print_warning(fmt::format(
      "'{}' is not closed: near such edges the sign is the winding number's guess; {} of the samples are inside", path,
      percent(inside / static_cast<double>(grid.values.size()))));
}

// ---- the two sources ----

/// Writes the grid; with --check, reads back what was written: that is what is checked.
void write_grid(const SdfOptions& options, voml::Grid& grid, Outputs& outputs) {
  const std::string bytes = voml::write_lxn(grid);
  outputs.write_bytes(options.grid, bytes);
  if (!options.check) return;
  Diagnostics diagnostics;
  grid = {};
  auto written = voml::parse_lxn(bytes, diagnostics.add_source(options.grid, ""), diagnostics);
  if (!written) fail_with({Fault::environment, "the grid that was written cannot be read", {diagnostics.render()}});
  grid = std::move(*written);
}

int sdf_of_mesh(const SdfOptions& options, Context& context) {
  Outputs outputs;
  outputs.announce(options.grid, {".lxn"});
  if (!options.fitted_mesh.empty()) outputs.announce(options.fitted_mesh, {".ply"});

  Diagnostics diagnostics(options.scene.strict);
  voml::Mesh mesh = read_mesh(options.mesh, context, diagnostics);
  print_diagnostics(diagnostics, context);
  authoring::GridOptions grid_options = options.grid_options;
  grid_options.fit = !options.no_fit;
  authoring::GridReport report;
  voml::Grid grid = must(authoring::distance_grid(mesh, grid_options, report, progress_bar(context)));
  context.stopwatch.lap("distances");
  if (!context.quiet) warn_of_edges(options.mesh, report.edges, grid);

  write_grid(options, grid, outputs);
  if (!options.fitted_mesh.empty()) outputs.write_bytes(options.fitted_mesh, write_ply(fitted(mesh, report)));
  outputs.commit();
  context.stopwatch.lap("write");
  if (!context.quiet) print_result(grid_text(options, grid, context));
  if (options.check) {
    print_result(check_text(authoring::check_grid(grid, mesh, report), true,
                            fmt::format("the {} of {}", plural(mesh.triangles.size(), "triangle"), options.mesh)));
    context.stopwatch.lap("check");
  }
  return exit_done;
}

int sdf_of_scene(const SdfOptions& options, Context& context) {
  Outputs outputs;
  outputs.announce(options.grid, {".lxn"});

  Diagnostics diagnostics(options.scene.strict);
  session::Session session = make_session(context);
  const compiler::Module module = read_module(session, options.scene, context, diagnostics);
  print_diagnostics(diagnostics, context);
  const Id<compiler::Sdf> sdf = must(authoring::find_sdf(module, options.sdf));
  const std::uint32_t resolution = options.grid_options.resolution;
  const authoring::Field field(module, sdf, options.time_ms, 4.0 / resolution);

  authoring::BakeReport report;
  const authoring::BakeOptions bake_options{.resolution = resolution,
                                            .padding = options.grid_options.padding,
                                            .distance = options.distance,
                                            .threads = options.grid_options.threads};
  voml::Grid grid = must(authoring::bake(field, bake_options, report, progress_bar(context)));
  context.stopwatch.lap(options.distance ? "distances" : "values");
  if (report.not_finite != 0 && !context.quiet) {
    print_warning(fmt::format("'{}' is no finite number at {}; 4 or -4 stands for it", options.sdf,
                              plural(report.not_finite, "sample")));
  }
  write_grid(options, grid, outputs);
  outputs.commit();
  context.stopwatch.lap("write");
  if (!context.quiet) print_result(grid_text(options, grid, context));
  if (options.check) {
    print_result(check_text(authoring::check_grid(grid, field, bake_options), false,
                            fmt::format("'{}' of {}", options.sdf, options.scene.path)));
    context.stopwatch.lap("check");
  }
  return exit_done;
}

int sdf(const SdfOptions& options, Context& context) {
  if (options.mesh.empty() == options.scene.path.empty()) {
    fail_usage(options.mesh.empty() ? "nothing to make a grid from" : "a mesh and --from at once",
               {"give a mesh, or --from SCENE --sdf NAME"});
  }
  if (options.mesh.empty() && options.sdf.empty()) fail_usage("--from needs --sdf NAME");
  std::vector<std::string> given = options.given;
  if (!options.scene.root.empty()) given.push_back("--root");
  if (options.time_ms != 0.0) given.push_back("--time");
  for (const std::string& name : given) {
    const bool of_meshes = name == "--no-fit" || name == "--write-mesh";
    if (of_meshes == options.mesh.empty()) {
      fail_usage(fmt::format("{} is for {}", name, of_meshes ? "meshes" : "--from"), {"leave it away"});
    }
  }
  return options.mesh.empty() ? sdf_of_scene(options, context) : sdf_of_mesh(options, context);
}

const char* const footer = R"(Examples:
  dmvv sdf skull.ply -o skull.lxn --resolution 128 --write-mesh skull_fitted.ply --check
  dmvv sdf --from scene.voml --sdf MEMBRANE -o membrane.lxn --time 500

From a mesh: exact distances to the triangles, negative where the surface winds around. From a scene: the SDF in the cube
of its object, transform, seeds and offset included, so that <SDF file="membrane.lxn"/> has the same inside. Values are
the SDF's own; --distance writes distances to its boundary instead. Memory: 8 bytes a sample (128 MiB at 256^3), some
300 bytes a triangle, with --distance 700 bytes a voxel on the boundary.

--check compares the written grid, sampled as scenes do, with the exact surface. It prints the greatest error, where it is
and the root mean square, in units of the cube (edge 2) and in voxels:
  on the surface   |grid| at points of the exact surface, where the exact distance is 0; for values that are no distances
                   divided by their slope: how far off the boundary is
  at samples       |value - exact value| at samples
  between samples  |grid - exact value| at points anywhere between samples
  wrong side       points at which the grid and the exact value have different signs, and how far they are from the surface
  boundary lost    share of the exact surface near which (within a voxel) the grid has none, because no sample lies in what is
                   thin; beyond 1 % with a resolution that would keep 99 %
More in spec/lxn.md, "How good a grid is".)";

}  // namespace

void add_sdf(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<SdfOptions>();
  CLI::App& command =
      *app.add_subcommand("sdf", "Make a distance grid (LXN) from a triangle mesh or from an SDF of a scene");
  const auto note = [options](CLI::Option* option, const std::string& name) {
    option->each([options, name](const std::string&) { options->given.push_back(name); });
  };
  command.add_option("MESH", options->mesh, "OBJ, PLY, STL or OFF file")->type_name("");
  command.add_option("--from", options->scene.path, "Instead of a mesh: a scene (VOML)")->type_name("SCENE");
  CLI::Option* sdf_name = command.add_option("--sdf", options->sdf, "The SDF of the scene")->type_name("NAME");
  note(sdf_name, "--sdf");
  command.add_option("-o,--output", options->grid, "Distance grid: .lxn")->required()->type_name("FILE");
  command
      .add_option("--resolution", options->grid_options.resolution,
                  "Samples along the longest side, 4 to 512; default 64")
      ->type_name("N")
      ->check(CLI::Range(4, 512));
  command
      .add_option("--padding", options->grid_options.padding,
                  "Border around the mesh or what is inside, a share of its longest side, 0 to 1; default 0.05")
      ->type_name("SHARE")
      ->check(CLI::Range(0.0, 1.0));
  command.add_flag("--check", options->check, "Report the error of the written grid, and where it is (see below)");
  command.add_flag_callback(
      "--no-fit", [options] { options->no_fit = true, options->given.push_back("--no-fit"); },
      "Keep the mesh's coordinates instead of fitting it into the cube");
  CLI::Option* write_mesh =
      command.add_option("--write-mesh", options->fitted_mesh, "Also write the mesh as it was fitted: .ply");
  write_mesh->type_name("FILE");
  note(write_mesh, "--write-mesh");
  command.add_flag_callback(
      "--distance", [options] { options->distance = true, options->given.push_back("--distance"); },
      "With --from: write distances to the SDF's boundary instead of its own values");
  add_time_option(command, options->time_ms);
  add_root_and_strict(command, options->scene);
  command.add_option("--threads", options->grid_options.threads, "Threads; default: one a core")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  add_common_options(command, invocation.context);
  command.footer(footer);
  command.callback(
      [&invocation, options] { invocation.command = [options](Context& context) { return sdf(*options, context); }; });
}

}  // namespace dmvv::cli
