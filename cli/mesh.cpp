// dmvv mesh SCENE -o SURFACE.ply: a support mesh of what a scene holds.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <memory>

#include "authoring/surface_mesh.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/outputs.h"
#include "cli/ply.h"

namespace dmvv::cli {
namespace {

struct MeshOptions {
  SceneOptions scene;
  DeviceChoice device;
  CodegenChoice codegen;
  double time_ms = 0;
  std::string mesh;
  authoring::SurfaceOptions surface;
};

int mesh(const MeshOptions& options, Context& context) {
  const compiler::CompileOptions form = compile_options(options.codegen);
  Outputs outputs;
  outputs.announce(options.mesh, {".ply"});

  session::Session session = make_session(options.device, context);
  Diagnostics diagnostics(options.scene.strict);
  voml::Scene scene = must(session.read(scene_file(options.scene), diagnostics), diagnostics, context);
  runtime::Evaluator evaluator =
      load(session, std::move(scene), form, compiler::Source::points, context, diagnostics).evaluator;
  const auto inside = [&](std::span<const glm::dvec3> points) -> Result<std::vector<char>> {
    const auto answers = evaluator.probe(points, options.time_ms);
    if (!answers) return tl::unexpected<Error>(answers.error());
    std::vector<char> sides;
    for (const compiler::PointAnswer& answer : *answers) sides.push_back(answer.number != 0 ? 1 : 0);
    return sides;
  };
  const voml::Mesh surface = must(authoring::surface_mesh(inside, options.surface));
  context.stopwatch.lap("surface");
  if (surface.triangles.empty()) {
    fail_with({Fault::input,
               fmt::format("'{}' is empty at every point that was looked at", options.scene.path),
               {"a finer --resolution finds smaller things"}});
  }
  if (const int exit_code = exit_code_of(session.validation_messages()); exit_code != exit_done) return exit_code;
  outputs.write_bytes(options.mesh, write_ply(surface));
  outputs.commit();
  context.stopwatch.lap("write");
  if (!context.quiet) {
    const voml::Bounds bounds = voml::bounds(surface);
    print_result(fmt::format("{}: {}, from {:.3f} {:.3f} {:.3f} to {:.3f} {:.3f} {:.3f}, {:.2f} s\n", options.mesh,
                             plural(surface.triangles.size(), "triangle"), bounds.lo.x, bounds.lo.y, bounds.lo.z,
                             bounds.hi.x, bounds.hi.y, bounds.hi.z, context.stopwatch.seconds()));
  }
  return exit_done;
}

}  // namespace

void add_mesh(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<MeshOptions>();
  CLI::App& command = *app.add_subcommand("mesh", "Write the surface of what a scene holds as a mesh");
  add_scene_options(command, options->scene);
  command.add_option("-o,--output", options->mesh, "Mesh (.ply)")->required()->type_name("MESH");
  command.add_option("--resolution", options->surface.resolution, "Cells along the standard cube's edge; default 128")
      ->check(CLI::Range(std::uint32_t{8}, authoring::max_surface_resolution))
      ->type_name("N");
  add_time_option(command, options->time_ms);
  add_codegen_options(command, options->codegen);
  add_device_options(command, options->device);
  add_common_options(command, invocation.context);
  command.footer(
      "Pictures need no mesh: rays find what a scene holds. A mesh is for other programs, and for pictures of\n"
      "its points alone (dmvv render --mesh). Vertices lie inside; between them the mesh may pass\n"
      "outside by less than a cell, where the picture has holes: a region asked last that fills the cube closes them.\n"
      "Examples: dmvv mesh capsid.voml -o capsid.ply --resolution 192\n"
      "          dmvv render capsid.voml --mesh capsid.ply -o capsid.png");
  command.callback(
      [&invocation, options] { invocation.command = [options](Context& context) { return mesh(*options, context); }; });
}

}  // namespace dmvv::cli
