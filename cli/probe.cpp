// dmvv probe SCENE: what the scene is at points.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <iostream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>

#include "cli/commands.h"
#include "cli/explain.h"
#include "cli/options.h"
#include "compiler/ir/legend.h"
#include "compiler/reference/reference.h"
#include "voml/assets/grid.h"

namespace dmvv::cli {
namespace {

struct ProbeOptions {
  SceneOptions scene;
  DeviceChoice device;
  CodegenChoice codegen;
  double time_ms = 0;
  std::string points_file;
  std::vector<std::string> points;
  std::string backend = "reference";
  bool json = false;
  bool explain = false;
};

std::vector<glm::dvec3> parse_points(const std::string& name, std::string text, int exit_code, Context& context) {
  Diagnostics diagnostics;
  const SourceId source = diagnostics.add_source(name, std::move(text));
  auto points = voml::parse_vectors(source, diagnostics);
  if (points) return std::move(*points);
  print_diagnostics(diagnostics, context);
  throw Stop{exit_code};
}

/// The points of --points, then those of --point.
std::vector<glm::dvec3> read_points(const ProbeOptions& options, Context& context) {
  std::vector<glm::dvec3> points;
  if (options.points_file.empty() && options.points.empty()) {
    fail_usage("no points given", {"use --points FILE, --points - or --point \"X Y Z\""});
  }
  if (options.points_file == "-") {
    points = parse_points("<stdin>", std::string(std::istreambuf_iterator<char>(std::cin), {}), exit_input, context);
  } else if (!options.points_file.empty()) {
    points = parse_points(options.points_file, read_bytes(options.points_file), exit_input, context);
  }
  for (const std::string& text : options.points) {
    const auto one = parse_points("--point", text, exit_environment, context);
    if (one.size() != 1) fail_usage(fmt::format("--point: '{}' is not one point \"X Y Z\"", text));
    points.push_back(one.front());
  }
  return points;
}

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Colours are float32, whichever backend answers: their shortest text is that of a float.
std::string colour_text(const glm::dvec4& rgba, std::string_view separator) {
  return fmt::format("{}{}{}{}{}", static_cast<float>(rgba.r), separator, static_cast<float>(rgba.g), separator,
                     static_cast<float>(rgba.b));
}

std::string json_line(const glm::dvec3& p, const compiler::PointAnswer& answer,
                      const std::vector<compiler::RegionInfo>& regions) {
  const std::string point = fmt::format("[{},{},{}]", p.x, p.y, p.z);
  if (answer.number == 0) return fmt::format("{{\"p\":{},\"path\":null,\"region\":null,\"rgb\":null}}\n", point);
  return fmt::format("{{\"p\":{},\"path\":{},\"region\":{},\"rgb\":[{}]}}\n", point,
                     quoted(compiler::format_path(regions, answer.path)),
                     quoted(regions[answer.path.back().region].region), colour_text(answer.rgba, ","));
}

std::string plain_line(const glm::dvec3& p, const compiler::PointAnswer& answer,
                       const std::vector<compiler::RegionInfo>& regions) {
  if (answer.number == 0) return fmt::format("{} {} {}\tempty\n", p.x, p.y, p.z);
  return fmt::format("{} {} {}\t{}\t{}\n", p.x, p.y, p.z, compiler::format_path(regions, answer.path),
                     colour_text(answer.rgba, " "));
}

void print_answers(std::span<const glm::dvec3> points, std::span<const compiler::PointAnswer> answers,
                   const std::vector<compiler::RegionInfo>& regions, bool json) {
  std::string text;
  for (std::size_t i = 0; i < points.size(); ++i) {
    text += (json ? json_line : plain_line)(points[i], answers[i], regions);
  }
  print_result(text);
}

/// Each answer, as without --explain, and how it came about.
void print_explanations(const compiler::Module& module, const compiler::Reference& reference, compiler::Filter filter,
                        const ProbeOptions& options, std::span<const glm::dvec3> points) {
  const std::vector<compiler::RegionInfo> regions = compiler::legend(module);
  for (const glm::dvec3& p : points) {
    const compiler::Explanation explanation = compiler::explain(module, reference, filter, p, options.time_ms);
    if (options.json) {
      std::string line = json_line(p, explanation.answer, regions);
      line.resize(line.size() - 2);  // "}\n"
      print_result(line + ',' + explanation_json(module, explanation) + "}\n");
    } else {
      print_result(plain_line(p, explanation.answer, regions) + explanation_text(module, explanation));
    }
  }
}

int probe_reference(const ProbeOptions& options, std::span<const glm::dvec3> points, Context& context) {
  Diagnostics diagnostics(options.scene.strict);
  session::Session session = make_session(context);
  const compiler::Module module = read_module(session, options.scene, context, diagnostics);
  if (!compiler::can_evaluate(module, diagnostics)) stop_with(diagnostics, context);
  print_diagnostics(diagnostics, context);
  compiler::Reference::Options reading;
  reading.filter = compile_options(options.codegen).filter;
  const compiler::Reference reference(module, reading);
  if (options.explain) {
    print_explanations(module, reference, reading.filter, options, points);
    context.stopwatch.lap("explain");
    return exit_done;
  }
  std::vector<compiler::PointAnswer> answers;
  answers.reserve(points.size());
  for (const glm::dvec3& p : points) answers.push_back(reference.evaluate(p, options.time_ms));
  context.stopwatch.lap("evaluate");
  print_answers(points, answers, compiler::legend(module), options.json);
  context.stopwatch.lap("print");
  return exit_done;
}

int probe_vulkan(const ProbeOptions& options, std::span<const glm::dvec3> points, Context& context) {
  session::Session session = make_session(options.device, context);
  Diagnostics diagnostics(options.scene.strict);
  voml::Scene scene = must(session.read(scene_file(options.scene), diagnostics), diagnostics, context);
  runtime::Timings timings;
  auto [program, evaluator] = load(session, std::move(scene), compile_options(options.codegen),
                                   compiler::Source::points, context, diagnostics, &timings);
  const auto answers = must(evaluator.probe(points, options.time_ms, &timings));
  context.stopwatch.lap(timings, "other");
  if (const int exit_code = exit_code_of(session.validation_messages()); exit_code != exit_done) return exit_code;
  print_answers(points, answers, program.regions, options.json);
  context.stopwatch.lap("print");
  return exit_done;
}

int probe(const ProbeOptions& options, Context& context) {
  if (options.backend != "reference" && options.backend != "vulkan") {
    fail_usage(fmt::format("--backend: unknown backend '{}'", options.backend), {"use reference or vulkan"});
  }
  if (options.explain && options.backend != "reference") {
    fail_usage("--explain: only the reference knows how it came to its answer", {"leave --backend out"});
  }
  compile_options(options.codegen);  // refuses wrong usage on either backend
  const std::vector<glm::dvec3> points = read_points(options, context);
  const auto run = options.backend == "vulkan" ? probe_vulkan : probe_reference;
  return run(options, points, context);
}

}  // namespace

void add_probe(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<ProbeOptions>();
  CLI::App& command = *app.add_subcommand("probe", "Tell what a scene is at points");
  add_scene_options(command, options->scene);
  command
      .add_option("--points", options->points_file,
                  "File of points, \"X Y Z\" a line in root coordinates; - is the standard input")
      ->type_name("FILE");
  command.add_option("--point", options->points, "One point, \"X Y Z\" (repeatable)")
      ->type_name("POINT")
      ->allow_extra_args(false);
  command
      .add_option("--backend", options->backend,
                  "reference (default; double precision, on the CPU) or vulkan (the generated shader)")
      ->type_name("NAME");
  command.add_flag("--json", options->json, "One JSON object a line: p, path, region, rgb");
  command.add_flag(
      "--explain", options->explain,
      "Also tell what was asked on the way: every decision with its value and side, every candidate, down to "
      "the region, and how near another outcome is");
  add_time_option(command, options->time_ms);
  add_codegen_options(command, options->codegen);
  add_device_options(command, options->device);
  add_common_options(command, invocation.context);
  command.footer(
      "Examples: echo \"0 0.2 0.1\" | dmvv probe orange.voml --points - --json\n"
      "          dmvv probe orange.voml --point \"0.3 0 0.2\" --explain");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return probe(*options, context); };
  });
}

}  // namespace dmvv::cli
