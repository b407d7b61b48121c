#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/report.h"

namespace dmvv::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Seven digits: more than any clock here has, and short to read.
double rounded(double value) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10.0, 6.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

Json optional_number(const std::optional<double>& value) { return value ? Json(rounded(*value)) : Json(nullptr); }

/// Null where nothing was measured.
Json summary(const std::vector<double>& samples) {
  if (samples.empty()) return nullptr;
  Json list = Json::array();
  for (const double sample : samples) list.push_back(rounded(sample));
  return {{"median", rounded(median(samples))},
          {"p95", rounded(quantile(samples, 0.95))},
          {"mad", rounded(mad(samples))},
          {"count", samples.size()},
          {"samples", std::move(list)}};
}

Json regions(const std::optional<RegionErrors>& errors) {
  if (!errors) return nullptr;
  return {{"compared", errors->compared},
          {"wrong", errors->wrong},
          {"wrong_fraction", rounded(errors->wrong_fraction())},
          {"uncertain", errors->uncertain},
          {"uncertain_different", errors->uncertain_different}};
}

Json displacement(const Measurement& m) {
  if (!m.displacement) return nullptr;
  const Displacement& d = *m.displacement;
  const auto in_pixels = [&](double value) -> Json {
    return m.pixel_pitch ? Json(rounded(value / *m.pixel_pitch)) : Json(nullptr);
  };
  return {{"count", d.count},           {"lost", d.lost},
          {"max", rounded(d.max)},      {"rms", rounded(d.rms)},
          {"mean", rounded(d.mean)},    {"max_px", in_pixels(d.max)},
          {"rms_px", in_pixels(d.rms)}, {"pixel_pitch", optional_number(m.pixel_pitch)}};
}

Json settings(const Settings& s) {
  return {{"codegen", name_of(s.codegen)},    {"atlas", name_of(s.atlas)},
          {"filter", name_of(s.filter)},      {"samples", s.samples},
          {"motion", name_of(s.motion)},      {"verdicts", s.verdicts},
          {"surface_alone", s.surface_alone}, {"disabled_passes", s.disabled_passes}};
}

Json thesis(const std::optional<ThesisFigures>& figures) {
  if (!figures) return nullptr;
  return {{"objects", figures->objects},
          {"build_s_laptop", figures->build_s_laptop},
          {"build_s_desktop", figures->build_s_desktop},
          {"fps_laptop", figures->fps_laptop},
          {"fps_desktop", figures->fps_desktop}};
}

Json run(const Measurement& m) {
  const Case& what = m.what;
  Json entry{{"id", what.id},
             {"section", what.section},
             {"series", what.series},
             {"variant", what.variant},
             {"settings", settings(what.settings)}};
  entry["parameter"] =
      what.parameter ? Json{{"name", what.parameter->name}, {"value", what.parameter->value}} : Json(nullptr);
  entry["size_px"] = {what.size_px.x, what.size_px.y};
  entry["failure"] = m.failure.empty() ? Json(nullptr) : Json(m.failure);
  if (!m.failure.empty()) return entry;
  Json times = Json::object();
  for (const char* step : {"read", "compile", "SPIR-V", "upload", "pipeline"})
    times[step] = summary(samples_of(m, step));
  times["frame"] = summary(m.frame_ms);
  times["gpu"] = summary(m.gpu_ms);
  entry["times_ms"] = std::move(times);
  entry["settle"] = {{"frames", m.settle_frames}, {"ms", rounded(m.settle_ms)}};
  entry["build_ms"] = rounded(m.build_ms());
  entry["point_ns"] = summary(m.point_ns);
  entry["upload_bytes"] = m.upload_bytes;
  entry["peak_bytes"] = m.peak_bytes;
  entry["scene"] = {{"candidates", m.statistics.scene.candidates},
                    {"seeds", m.statistics.scene.seeds},
                    {"sdfs", m.statistics.scene.sdfs},
                    {"depth", m.statistics.scene.depth},
                    {"glsl_lines", m.statistics.code.glsl_lines},
                    {"inlined_lines", m.statistics.code.inlined_lines}};
  entry["errors"] = {{"points", regions(m.points)},
                     {"pixels", regions(m.pixels)},
                     {"differing_pixels", m.differing ? Json(*m.differing) : Json(nullptr)},
                     {"colour_rmse", optional_number(m.color_rmse)},
                     {"displacement", displacement(m)}};
  entry["thesis"] = thesis(what.thesis);
  return entry;
}

Json fit(const Fit& f) {
  return {{"series", f.series},
          {"quantity", f.quantity},
          {"parameter", f.parameter},
          {"from", f.from},
          {"to", f.to},
          {"exponent", rounded(f.law.exponent)},
          {"factor", rounded(f.law.factor)},
          {"r2", rounded(f.law.r2)},
          {"points", f.law.count},
          {"expected", optional_number(f.expected)},
          {"tolerance", f.tolerance},
          {"holds", f.expected ? Json(f.holds()) : Json(nullptr)},
          {"theory", f.source}};
}

Json machine(const Machine& m) {
  return {{"dmvv", m.dmvv},
          {"compiler", m.compiler},
          {"glslang", m.glslang},
          {"device", m.device},
          {"device_kind", m.device_kind},
          {"driver", m.driver},
          {"vulkan", m.vulkan},
          {"cpu", m.cpu},
          {"cores", m.cores},
          {"memory_bytes", m.memory_bytes},
          {"system", m.system},
          {"load", rounded(m.load)}};
}

}  // namespace

std::string to_json(const Report& report) {
  Json json{{"schema", schema_version},
            {"set", report.set},
            {"quick", report.quick},
            {"seconds", rounded(report.seconds)},
            {"machine", machine(report.machine)}};
  json["runs"] = Json::array();
  for (const Measurement& m : report.measurements) json["runs"].push_back(run(m));
  json["fits"] = Json::array();
  for (const Fit& f : report.fits) json["fits"].push_back(fit(f));
  json["missing"] = Json::array();
  for (const Missing& m : report.missing) json["missing"].push_back({{"scene", m.scene}, {"reason", m.reason}});
  json["stress"] = Json::array();
  for (const StressFigure& f : report.stress) {
    json["stress"].push_back({{"name", f.name},
                              {"what", f.what},
                              {"measured", rounded(f.measured)},
                              {"bound", rounded(f.bound)},
                              {"at_least", f.at_least},
                              {"unit", f.unit},
                              {"detail", f.detail},
                              {"held", f.held}});
  }
  json["starts"] = Json::array();
  for (const Starts& s : report.starts) {
    json["starts"].push_back({{"scene", s.scene},
                              {"failure", s.failure.empty() ? Json(nullptr) : Json(s.failure)},
                              {"cold_ms", summary(s.cold_ms)},
                              {"warm_ms", summary(s.warm_ms)}});
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace dmvv::bench
