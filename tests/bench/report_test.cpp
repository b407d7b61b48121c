// JSON whose keys stay, tables that fit a terminal, plots that name their axes.
#include "bench/report.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <sstream>

using namespace dmvv;
using namespace dmvv::bench;
using Json = nlohmann::ordered_json;

namespace {

Measurement measured(const std::string& section, const std::string& variant_name, double n) {
  Measurement m;
  m.what.id = section + "/" + variant_name;
  m.what.section = section;
  m.what.series = "sphere";
  m.what.variant = variant_name;
  m.what.parameter = Parameter{"resolution", n};
  m.steps = {{"read", {1.0, 2.0, 3.0}}, {"compile", {4.0}}, {"SPIR-V", {5.0}}, {"upload", {6.0}}, {"pipeline", {7.0}}};
  m.frame_ms = {10.0, 20.0, 30.0, 40.0, 50.0};
  m.gpu_ms = {9.0};
  m.point_ns = {3.0};
  m.points = RegionErrors{100, 1, 10, 5};
  m.pixels = RegionErrors{1000, 0, 0, 0};
  m.color_rmse = 0.25;
  m.displacement = Displacement{10, 0, 4.0 / (n * n), 2.0 / (n * n), 0.0};
  m.pixel_pitch = 0.01;
  return m;
}

Report report() {
  Report made;
  made.set = "standard";
  made.machine.device = "device";
  for (const double n : {16.0, 32.0, 64.0}) made.measurements.push_back(measured("boundary", "auto", n));
  made.measurements.push_back(measured("scene", "table", 1.0));
  made.measurements.push_back(measured("scene", "auto", 1.0));
  Measurement failed;
  failed.what.id = "x";
  failed.failure = "why";
  made.measurements.push_back(failed);
  made.stress = {{"deep: wrong answers", "", 1.0, 0.0, false, "points", "at 0 0 0", false}};
  made.missing = {{"skin", "not there yet"}};
  made.fits = fit_series(made.measurements);
  return made;
}

std::string keys(const Json& object) {
  std::string text;
  for (const auto& [key, value] : object.items()) text += (text.empty() ? "" : " ") + key;
  return text;
}

}  // namespace

TEST_CASE("the JSON has the keys of its description, in their order") {
  const std::string text = to_json(report());
  CHECK(text == to_json(report()));
  const Json json = Json::parse(text);
  CHECK(keys(json) == "schema set quick seconds machine runs fits missing stress starts");
  CHECK(json["schema"] == 5);
  CHECK(keys(json["machine"]) ==
        "dmvv compiler glslang device device_kind driver vulkan cpu cores memory_bytes system load");
  const Json& run = json["runs"][0];
  CHECK(keys(run) ==
        "id section series variant settings parameter size_px failure times_ms settle build_ms point_ns upload_bytes "
        "peak_bytes scene errors thesis");
  CHECK(keys(run["settings"]) == "codegen atlas filter samples motion verdicts surface_alone disabled_passes");
  CHECK(keys(run["times_ms"]) == "read compile SPIR-V upload pipeline frame gpu");
  CHECK(keys(run["times_ms"]["frame"]) == "median p95 mad count samples");
  CHECK(keys(run["scene"]) == "candidates seeds sdfs depth glsl_lines inlined_lines");
  CHECK(keys(run["errors"]) == "points pixels differing_pixels colour_rmse displacement");
  CHECK(keys(run["errors"]["points"]) == "compared wrong wrong_fraction uncertain uncertain_different");
  CHECK(keys(run["errors"]["displacement"]) == "count lost max rms mean max_px rms_px pixel_pitch");
  CHECK(keys(json["fits"][0]) ==
        "series quantity parameter from to exponent factor r2 points expected tolerance holds theory");
  CHECK(keys(json["stress"][0]) == "name what measured bound at_least unit detail held");
  CHECK(json["runs"].back()["failure"] == "why");
}

TEST_CASE("the JSON's figures are those that were measured") {
  const Json json = Json::parse(to_json(report()));
  const Json& run = json["runs"][0];
  CHECK(run["times_ms"]["frame"]["median"] == 30.0);
  CHECK(run["times_ms"]["frame"]["p95"] == 48.0);
  CHECK(run["times_ms"]["frame"]["mad"] == 10.0);
  CHECK(run["times_ms"]["frame"]["samples"].size() == 5);
  CHECK(run["build_ms"] == 24.0);  // medians 2 + 4 + 5 + 6 + 7
  CHECK(run["errors"]["points"]["wrong_fraction"] == 0.01);
  CHECK(run["errors"]["displacement"]["rms_px"].get<double>() == doctest::Approx(2.0 / 256.0 / 0.01));
  CHECK(json["fits"][0]["exponent"].get<double>() == doctest::Approx(2.0));
  CHECK(json["fits"][0]["holds"] == true);
}

TEST_CASE("an exponent away from theory is told") {
  Report odd = report();
  for (Measurement& m : odd.measurements) {
    if (m.displacement) m.displacement->rms = std::sqrt(m.displacement->rms);  // first order
  }
  const auto fits = fit_series(odd.measurements);
  CHECK(fits[0].law.exponent == doctest::Approx(1.0));
  CHECK_FALSE(fits[0].holds());
}

TEST_CASE("tables fit 100 columns and name what is missing") {
  const std::string text = to_table(report());
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) CHECK_MESSAGE(line.size() <= 100, line);
  CHECK(text.find("skin: not there yet") != std::string::npos);
  CHECK(text.find("deep: wrong answers: at 0 0 0") != std::string::npos);
  CHECK(text.find("x: why") != std::string::npos);
}

TEST_CASE("plots name their axes and hold their data") {
  std::vector<std::string> names;
  for (const Plot& plot : make_plots(report())) {
    names.push_back(plot.name);
    CHECK(plot.script.find("set xlabel '") != std::string::npos);
    CHECK(plot.script.find("set title '") != std::string::npos);
    CHECK(plot.script.find("plot ") != std::string::npos);
  }
  CHECK(names == std::vector<std::string>{"convergence_sphere", "error_time_sphere", "settings_sphere"});
  CHECK(make_plots({}).empty());
}
