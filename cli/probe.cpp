// dmvv probe SCENE: what the scene is at points.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <iostream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>

#include "cli/commands.h"
#include "cli/explain.h"
#include "cli/options.h"
#include "compiler/ir/legend.h"
#include "compiler/rays/ray_reference.h"
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
  std::vector<std::string> rays;
  std::vector<std::string> cuts;
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
  if (options.points_file.empty() && options.points.empty() && options.rays.empty()) {
    fail_usage("no points given", {"use --points FILE, --points -, --point \"X Y Z\" or --ray \"OX OY OZ DX DY DZ\""});
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

/// The rays of --ray: an origin and a direction each.
std::vector<compiler::Ray> read_rays(const ProbeOptions& options) {
  std::vector<compiler::Ray> rays;
  for (const std::string& text : options.rays) {
    std::istringstream words(text);
    const std::vector<double> n{std::istream_iterator<double>(words), {}};
    const bool is_whole =
        words.eof() && n.size() == 6 && std::ranges::all_of(n, [](double x) { return std::isfinite(x); });
    if (!is_whole) fail_usage(fmt::format("--ray: '{}' is not an origin and a direction \"OX OY OZ DX DY DZ\"", text));
    const compiler::Ray ray{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    const double length = glm::length(ray.direction);
    if (!(length > 0.0) || !std::isfinite(length))
      fail_usage(fmt::format("--ray: the direction of '{}' has the length {}", text, length));
    rays.push_back(ray);
  }
  return rays;
}

std::vector<compiler::Cut> read_cuts(const ProbeOptions& options) {
  std::vector<compiler::Cut> cuts;
  for (const std::string& text : options.cuts) {
    const runtime::Plane plane = must_parse("--cut", runtime::parse_plane(text));
    cuts.push_back({plane.normal, plane.d});
  }
  return cuts;
}

/// What is asked: points, or rays with their cuts.
struct Questions {
  std::vector<glm::dvec3> points;
  std::vector<compiler::Ray> rays;
  std::vector<compiler::Cut> cuts;
};

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

// ---- rays ----

/// What a ray crosses at t: the test that is nearest to another outcome there.
std::string cause_at(const compiler::Module& module, const compiler::RayReference& reference, compiler::Filter filter,
                     const compiler::Ray& ray, double t, double time_ms) {
  const glm::dvec3 p = ray.origin + t * ray.direction;
  if (t == 0.0) return "the ray's origin";
  if (glm::any(glm::greaterThanEqual(glm::abs(p), glm::dvec3(1.0 - 1e-9)))) return "the standard cube";
  const compiler::Explanation there = compiler::explain(module, reference.points(), filter, p, time_ms);
  return there.nearest.distance < 1e-6 ? there.nearest.what : "a cut";
}

std::string json_number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }

std::string ray_json(const compiler::Ray& ray, const compiler::RayAnswer& answer,
                     const std::vector<compiler::RegionInfo>& regions,
                     const std::function<std::string(double)>& cause) {
  const glm::dvec3 &o = ray.origin, &d = ray.direction;
  std::string segments;
  for (const compiler::RaySegment& segment : answer.segments) {
    segments += fmt::format("{}{{\"t0\":{},\"t1\":{},\"path\":{}", segments.empty() ? "" : ",", segment.t0, segment.t1,
                            quoted(compiler::format_path(regions, segment.path)));
    if (cause)
      segments += fmt::format(",\"at_t0\":{},\"at_t1\":{},\"t0_error\":{},\"t1_error\":{},\"certain\":{}",
                              quoted(cause(segment.t0)), quoted(cause(segment.t1)), segment.t0_error, segment.t1_error,
                              segment.certain);
    segments += '}';
  }
  const glm::dvec4& c = answer.rgba;
  return fmt::format(
      "{{\"o\":[{},{},{}],\"d\":[{},{},{}],\"segments\":[{}],\"rgba\":[{},{},{},{}],\"depth\":{},\"certain\":{}}}\n",
      o.x, o.y, o.z, d.x, d.y, d.z, segments, c.r, c.g, c.b, c.a, json_number(answer.depth), answer.certain);
}

std::string ray_text(const compiler::Ray& ray, const compiler::RayAnswer& answer,
                     const std::vector<compiler::RegionInfo>& regions,
                     const std::function<std::string(double)>& cause) {
  const glm::dvec3 &o = ray.origin, &d = ray.direction;
  std::string text = fmt::format("{} {} {} {} {} {}\t", o.x, o.y, o.z, d.x, d.y, d.z);
  if (answer.segments.empty()) return text + "nothing\n";
  const glm::dvec4& c = answer.rgba;
  text += fmt::format("{:.6g} {:.6g} {:.6g} opacity {:.6g}{}\n", c.r, c.g, c.b, c.a,
                      answer.certain ? "" : " (too near to be certain)");
  for (const compiler::RaySegment& segment : answer.segments) {
    text +=
        fmt::format("  {:.9g} to {:.9g}\t{}\n", segment.t0, segment.t1, compiler::format_path(regions, segment.path));
    if (cause) {
      text += fmt::format("    from {} (to within {:.2g}) to {} (to within {:.2g}){}\n", cause(segment.t0),
                          segment.t0_error, cause(segment.t1), segment.t1_error,
                          segment.certain ? "" : ": too near to be certain");
    }
  }
  return text;
}

void follow_rays(const compiler::Module& module, const compiler::Reference::Options& reading,
                 const ProbeOptions& options, const Questions& asked, Context& context) {
  const compiler::RayReference reference(module, reading);
  const std::vector<compiler::RegionInfo> regions = compiler::legend(module);
  for (const compiler::Ray& ray : asked.rays) {
    const compiler::RayAnswer answer = reference.along(ray, asked.cuts, options.time_ms);
    std::function<std::string(double)> cause;
    if (options.explain) {
      cause = [&](double t) { return cause_at(module, reference, reading.filter, ray, t, options.time_ms); };
    }
    print_result((options.json ? ray_json : ray_text)(ray, answer, regions, cause));
  }
  context.stopwatch.lap("rays");
}

int probe_reference(const ProbeOptions& options, const Questions& asked, Context& context) {
  const std::vector<glm::dvec3>& points = asked.points;
  Diagnostics diagnostics(options.scene.strict);
  session::Session session = make_session(context);
  const compiler::Module module = read_module(session, options.scene, context, diagnostics);
  if (!compiler::can_evaluate(module, diagnostics)) stop_with(diagnostics, context);
  print_diagnostics(diagnostics, context);
  compiler::Reference::Options reading;
  reading.filter = compile_options(options.codegen).filter;
  if (!asked.rays.empty()) {
    follow_rays(module, reading, options, asked, context);
    return exit_done;
  }
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

int probe_vulkan(const ProbeOptions& options, const Questions& asked, Context& context) {
  const std::vector<glm::dvec3>& points = asked.points;
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
  const bool asks_points = !options.points_file.empty() || !options.points.empty();
  if (!options.rays.empty() && asks_points) fail_usage("--ray: points and rays are asked apart", {"leave one out"});
  if (!options.rays.empty() && options.backend != "reference")
    fail_usage("--ray: the reference alone follows rays", {"leave --backend out"});
  if (options.rays.empty() && !options.cuts.empty()) fail_usage("--cut is for --ray", {"leave it away"});
  const Questions asked{read_points(options, context), read_rays(options), read_cuts(options)};
  const auto run = options.backend == "vulkan" ? probe_vulkan : probe_reference;
  return run(options, asked, context);
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
      .add_option("--ray", options->rays,
                  "One ray, \"OX OY OZ DX DY DZ\": what it meets, where, and what is seen (repeatable)")
      ->type_name("RAY")
      ->allow_extra_args(false);
  command.add_option("--cut", options->cuts, "\"NX NY NZ D\" takes away n.x > D before rays are followed (repeatable)")
      ->type_name("PLANE")
      ->allow_extra_args(false);
  command
      .add_option("--backend", options->backend,
                  "reference (default; double precision, on the CPU) or vulkan (the generated shader)")
      ->type_name("NAME");
  command.add_flag("--json", options->json,
                   "One JSON object a line: p, path, region, rgb; of a ray o, d, segments, rgba, depth, certain");
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
      "          dmvv probe orange.voml --point \"0.3 0 0.2\" --explain\n"
      "          dmvv probe orange.voml --ray \"0 0 5 0 0 -1\" --json");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return probe(*options, context); };
  });
}

}  // namespace dmvv::cli
