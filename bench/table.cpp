#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/report.h"
#include "bench/text_table.h"

namespace dmvv::bench {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string fraction(const std::optional<RegionErrors>& errors) {
  return errors ? number(errors->wrong_fraction()) : "-";
}

/// Points that the reference is not certain of are not compared: their share.
std::string uncertain(const std::optional<RegionErrors>& errors) {
  if (!errors || errors->compared + errors->uncertain == 0) return "-";
  return number(static_cast<double>(errors->uncertain) / static_cast<double>(errors->compared + errors->uncertain));
}

std::string mib(std::uint64_t bytes) { return number(static_cast<double>(bytes) / 1048576.0); }

bool fine(const Measurement& m, const std::string& section) { return m.what.section == section && m.failure.empty(); }

std::string heading(const std::string& title, const TextTable& table, const std::string& below = {}) {
  return table.empty() ? std::string() : fmt::format("{}\n{}{}\n", title, table.text(), below);
}

std::vector<std::string> series_of(const Report& report, const std::string& section) {
  std::vector<std::string> names;
  for (const Measurement& m : report.measurements) {
    if (fine(m, section) && std::ranges::find(names, m.what.series) == names.end()) names.push_back(m.what.series);
  }
  return names;
}

std::string boundaries(const Report& report) {
  std::string text;
  for (const std::string& shape : series_of(report, "boundary")) {
    TextTable table({"setting", "samples", "max", "RMS", "max", "RMS", "wrong px", "colour", "point", "frame"},
                    {"", "a side", "units", "units", "px", "px", "of 1", "RMSE", "ns", "ms"});
    for (const Measurement& m : report.measurements) {
      if (!fine(m, "boundary") || m.what.series != shape || !m.displacement) continue;
      const Displacement& d = *m.displacement;
      table.add({m.what.variant, fmt::format("{:.0f}", m.what.parameter->value), number(d.max), number(d.rms),
                 number(d.max / m.pixel_pitch.value_or(nan)), number(d.rms / m.pixel_pitch.value_or(nan)),
                 fraction(m.pixels), number(m.color_rmse.value_or(nan)), number(median(m.point_ns)),
                 number(median(m.frame_ms))});
    }
    text += heading(
        fmt::format("A {}: how far the drawn boundary lies from the true one (px: of a 512 px slice)", shape), table);
  }
  return text;
}

std::string fits(const Report& report) {
  TextTable table({"series", "quantity", "against", "from", "to", "exponent", "expected", "holds"},
                  {"", "", "", "", "", "", "", ""});
  for (const Fit& fit : report.fits) {
    table.add({fit.series, fit.quantity, fit.parameter == "resolution" ? "step" : fit.parameter,
               fmt::format("{:.0f}", fit.from), fmt::format("{:.0f}", fit.to), fmt::format("{:.2f}", fit.law.exponent),
               fit.expected ? fmt::format("{:.1f}+-{:.1f}", *fit.expected, fit.tolerance) : "-",
               fit.expected ? (fit.holds() ? "yes" : "NO") : "-"});
  }
  return heading("Exponents (least squares in the logarithms)", table);
}

std::string samples(const Report& report) {
  TextTable table({"samples a pixel", "colour RMSE", "frame", "p95", "gpu"}, {"", "of 1", "ms", "ms", "ms"});
  for (const Measurement& m : report.measurements) {
    if (!fine(m, "samples")) continue;
    const double n = m.what.parameter->value;
    table.add({fmt::format("{:.0f} x {:.0f}", n, n), number(m.color_rmse.value_or(nan)), number(median(m.frame_ms)),
               number(quantile(m.frame_ms, 0.95)), number(median(m.gpu_ms))});
  }
  return heading("Samples: the colours of a slice against 16 x 16 reference samples a pixel", table);
}

std::string growth(const Report& report) {
  TextTable table({"growing", "to", "build", "frame", "p95", "gpu", "point", "upload", "peak", "wrong"},
                  {"", "", "ms", "ms", "ms", "ms", "ns", "MiB", "MiB", "points"});
  for (const Measurement& m : report.measurements) {
    if (!fine(m, "growth")) continue;
    table.add({fmt::format("{}, {}", m.what.series, m.what.variant), number(m.what.parameter->value),
               number(m.build_ms()), number(median(m.frame_ms)), number(quantile(m.frame_ms, 0.95)),
               number(median(m.gpu_ms)), number(median(m.point_ns)), mib(m.upload_bytes), mib(m.peak_bytes),
               fraction(m.points)});
  }
  return heading("Growth (640x360 unless the picture grows)", table);
}

std::string scenes(const Report& report, const std::string& section) {
  std::string text;
  for (const std::string& scene : series_of(report, section)) {
    TextTable table({"setting", "build", "frame", "p95", "gpu", "point", "upload", "peak", "wrong", "wrong", "unsure"},
                    {"", "ms", "ms", "ms", "ms", "ns", "MiB", "MiB", "points", "pixels", "pixels"});
    for (const Measurement& m : report.measurements) {
      if (!fine(m, section) || m.what.series != scene) continue;
      table.add({m.what.variant, number(m.build_ms()), number(median(m.frame_ms)), number(quantile(m.frame_ms, 0.95)),
                 number(median(m.gpu_ms)), number(median(m.point_ns)), mib(m.upload_bytes), mib(m.peak_bytes),
                 fraction(m.points), fraction(m.pixels), uncertain(m.pixels)});
    }
    text += heading(fmt::format("{}, with every setting", scene), table);
  }
  return text;
}

const Measurement* find(const Report& report, const std::string& section, const std::string& series,
                        const std::string& variant) {
  for (const Measurement& m : report.measurements) {
    if (fine(m, section) && m.what.series == series && m.what.variant == variant) return &m;
  }
  return nullptr;
}

double frame_of(const Measurement* m) { return m != nullptr ? median(m->frame_ms) : nan; }

class GeometricMean {
 public:
  void add(double x) {
    if (!std::isfinite(x)) return;
    log_sum_ += std::log(x);
    ++count_;
    least_ = std::min(least_, x);
  }
  std::string text() const {
    if (count_ == 0) return "-";
    return fmt::format("{} (at least {})", number(std::exp(log_sum_ / static_cast<double>(count_))), number(least_));
  }

 private:
  double log_sum_ = 0.0, least_ = std::numeric_limits<double>::infinity();
  std::size_t count_ = 0;
};

/// Ratios to the table form, and to a frame of one colour, in the same run.
std::string speed(const Report& report) {
  TextTable table({"scene, view", "table", "surface", "anew", "swings", "time", "table/", "table/", "swings/", "time/",
                   "settle", "differ", "wrong"},
                  {"", "ms", "ms", "ms", "ms", "ms", "swings", "time", "floor", "floor", "s", "px", "px"});
  const double floor = frame_of(find(report, "speed", floor_series, "auto"));
  GeometricMean swings_gain, time_gain, limit;
  for (const std::string& series : series_of(report, "speed")) {
    if (series == floor_series) continue;
    const Measurement* anew = find(report, "speed", series, "auto");
    const Measurement* swings = find(report, "speed", series, "camera swings");
    const Measurement* time = find(report, "speed", series, "time goes on");
    const double base = frame_of(find(report, "speed", series, "table"));
    const double surface = frame_of(find(report, "speed", series, surface_alone));
    limit.add(base / surface);
    swings_gain.add(base / frame_of(swings));
    time_gain.add(base / frame_of(time));
    std::size_t differing = 0;
    for (const Measurement* m : {swings, time}) differing += m != nullptr ? m->differing.value_or(0) : 0;
    const auto or_dash = [](double value) { return std::isfinite(value) ? number(value) : std::string("-"); };
    table.add({series, or_dash(base), or_dash(surface), or_dash(frame_of(anew)), or_dash(frame_of(swings)),
               or_dash(frame_of(time)), or_dash(base / frame_of(swings)), or_dash(base / frame_of(time)),
               or_dash(frame_of(swings) / floor), or_dash(frame_of(time) / floor),
               swings != nullptr ? number(1e-3 * swings->settle_ms) : "-", fmt::format("{}", differing),
               anew != nullptr ? fraction(anew->pixels) : "-"});
  }
  return heading(
      "Speed (1280x720): the camera swings, or time goes on; against the table form and a frame of one colour", table,
      fmt::format(
          "  floor: a frame of one colour, {} ms. Geometric means: table/swings {}, table/time {}, table/surface {}.\n"
          "  surface: mesh and cuts with a scene of one region, the limit of swings. anew: without verdicts, nothing "
          "kept. settle: frames while\n"
          "  verdicts are found. differ: regions that are others with all passes of a frame off.\n",
          number(floor), swings_gain.text(), time_gain.text(), limit.text()));
}

std::string starts(const Report& report) {
  TextTable table({"scene", "cold", "p95", "warm", "p95"}, {"", "ms", "ms", "ms", "ms"});
  for (const Starts& s : report.starts) {
    if (!s.failure.empty()) continue;
    table.add({s.scene, number(median(s.cold_ms)), number(quantile(s.cold_ms, 0.95)), number(median(s.warm_ms)),
               number(quantile(s.warm_ms, 0.95))});
  }
  return heading("Starts (1280x720): `dmvv render` from its start to its end, with empty caches and with its own",
                 table);
}

/// What each pass of a frame saves.
std::string passes(const Report& report) {
  TextTable table({"scene, motion", "setting", "frame", "p95", "to all"}, {"", "", "ms", "ms", "passes"});
  for (const Measurement& m : report.measurements) {
    if (!fine(m, "passes")) continue;
    const Measurement* all = find(report, "passes", m.what.series, m.what.series.substr(m.what.series.rfind(", ") + 2));
    table.add({m.what.series, m.what.variant, number(median(m.frame_ms)), number(quantile(m.frame_ms, 0.95)),
               number(median(m.frame_ms) / frame_of(all))});
  }
  return heading("Passes of a frame, each off alone", table);
}

/// The columns of the thesis' table 4.1, and the errors; after our rows of a scene the thesis' own.
std::string thesis(const Report& report) {
  TextTable table({"object", "embedded objects", "build", "avg.", "wrong", "wrong"},
                  {"", "", "s", "fps", "points", "pixels"});
  for (const std::string& scene : series_of(report, "thesis")) {
    const ThesisFigures* figures = nullptr;
    for (const Measurement& m : report.measurements) {
      if (!fine(m, "thesis") || m.what.series != scene) continue;
      figures = &*m.what.thesis;
      table.add({fmt::format("{}, {}", scene, m.what.variant), fmt::format("{}", m.statistics.scene.candidates),
                 number(1e-3 * m.build_ms()), number(1e3 / median(m.frame_ms)), fraction(m.points),
                 fraction(m.pixels)});
    }
    const std::string objects = fmt::format("{}", figures->objects);
    table.add(
        {"  as published, laptop", objects, number(figures->build_s_laptop), number(figures->fps_laptop), "-", "-"});
    table.add(
        {"  as published, desktop", objects, number(figures->build_s_desktop), number(figures->fps_desktop), "-", "-"});
  }
  return heading(
      "Table 4.1 of the thesis: ours (specialised, table, its way: thesis) and as published", table,
      "  Published on: GeForce GT 540M, i7-2670QM (laptop); GTX TITAN, i7 960 (desktop); frame size unknown,\n"
      "  moving camera. Its scenes were not published; ours have their structure. Our fps: each frame is drawn and "
      "evaluated anew.\n");
}

std::string stress(const Report& report) {
  TextTable table({"stress case", "measured", "bound", "unit", "held"}, {"", "", "", "", ""});
  std::string details;
  for (const StressFigure& f : report.stress) {
    table.add(
        {f.name, number(f.measured), (f.at_least ? ">= " : "<= ") + number(f.bound), f.unit, f.held ? "yes" : "NO"});
    if (!f.held && !f.detail.empty()) details += fmt::format("  {}: {}\n", f.name, f.detail);
  }
  return heading("Stress: figures that have a bound", table, details);
}

std::string failures(const Report& report) {
  std::string text;
  for (const Missing& missing : report.missing) text += fmt::format("  {}: {}\n", missing.scene, missing.reason);
  for (const Measurement& m : report.measurements) {
    if (!m.failure.empty()) text += fmt::format("  {}: {}\n", m.what.id, m.failure);
  }
  for (const Starts& s : report.starts) {
    if (!s.failure.empty()) text += fmt::format("  start of {}: {}\n", s.scene, s.failure);
  }
  return text.empty() ? text : "Not measured\n" + text + '\n';
}

}  // namespace

std::string to_table(const Report& report) {
  const Machine& m = report.machine;
  std::string text =
      fmt::format("dmvv {}, {}{}\n{}, {}\n{}, {} cores, load {:.2f}; {}, glslang {}\n\n", m.dmvv, report.set,
                  report.quick ? " (quick)" : "", m.device, m.driver, m.cpu, m.cores, m.load, m.compiler, m.glslang);
  text += boundaries(report);
  text += samples(report);
  text += growth(report);
  text += scenes(report, "scene");
  text += stress(report);
  text += thesis(report);
  text += speed(report);
  text += starts(report);
  text += passes(report);
  text += fits(report);
  text += failures(report);
  text +=
      "0 is exactly none. Wrong: share of the reference's certain answers that the device contradicts;\n"
      "unsure: share that it is not certain of. p95, gpu: of the frames. point: one evaluation.\n"
      "peak: memory beyond what was there before.\n";
  return text;
}

}  // namespace dmvv::bench
