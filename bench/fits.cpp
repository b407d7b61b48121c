#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/report.h"

namespace dmvv::bench {
namespace {

using compiler::Filter;
using compiler::TexelFormat;

/// What theory says of a boundary's displacement as the grid's step h shrinks.
struct Expectation {
  std::optional<double> exponent;
  double tolerance = 0.0;
  std::string source;
  double finest = 1e9;  ///< resolution beyond which the format's floor is what is measured
};

Expectation expectation(const Settings& settings) {
  if (settings.codegen == compiler::Codegen::thesis) return {{}, 0.0, "0: its errors do not shrink with h", 1e9};
  if (settings.filter == Filter::tricubic) return {3.0, 0.3, "Catmull-Rom is of third order (Keys 1981)", 96.0};
  if (settings.atlas == TexelFormat::snorm8) return {{}, 0.0, "2, then 1: steps of 8 bits are up to 1.2 % of h", 1e9};
  return {2.0, 0.1, "linear interpolation: h^2 f''/8 an axis", 1e9};  // 16 bits: 8.5e-4 h at most, seen beyond n = 1000
}

/// Points of a series, by its parameter.
struct Series {
  const Measurement* first = nullptr;
  std::vector<const Measurement*> members;
};

std::vector<Series> series_of(const std::vector<Measurement>& measurements, const std::string& section) {
  std::vector<Series> all;
  for (const Measurement& m : measurements) {
    if (m.what.section != section || !m.failure.empty() || !m.what.parameter) continue;
    const auto same = std::ranges::find_if(all, [&](const Series& s) {
      return s.first->what.series == m.what.series && s.first->what.variant == m.what.variant;
    });
    if (same == all.end()) {
      all.push_back({&m, {&m}});
    } else {
      same->members.push_back(&m);
    }
  }
  return all;
}

template <class X, class Y>
void add_fit(std::vector<Fit>& fits, const Series& series, const std::string& quantity, double finest, X x_of, Y y_of,
             const Fit& about) {
  std::vector<double> x, y, parameters;
  for (const Measurement* m : series.members) {
    if (m->what.parameter->value > finest) continue;
    x.push_back(x_of(*m));
    y.push_back(y_of(*m));
    parameters.push_back(m->what.parameter->value);
  }
  if (x.size() < 3) return;
  const auto law = fit_power_law(x, y);
  if (!law) return;
  Fit fit = about;
  fit.series = fmt::format("{}, {}", series.first->what.series, series.first->what.variant);
  fit.quantity = quantity;
  fit.parameter = series.first->what.parameter->name;
  fit.from = *std::ranges::min_element(parameters);
  fit.to = *std::ranges::max_element(parameters);
  fit.law = *law;
  fits.push_back(std::move(fit));
}

}  // namespace

bool Fit::holds() const { return !expected || std::abs(law.exponent - *expected) <= tolerance; }

std::vector<Fit> fit_series(const std::vector<Measurement>& measurements) {
  std::vector<Fit> fits;
  for (const Series& series : series_of(measurements, "boundary")) {
    const Expectation theory = expectation(series.first->what.settings);
    Fit about;
    about.expected = theory.exponent;
    about.tolerance = theory.tolerance;
    about.source = theory.source;
    const auto step = [](const Measurement& m) { return 2.0 / m.what.parameter->value; };
    add_fit(
        fits, series, "displacement rms", theory.finest, step,
        [](const Measurement& m) { return m.displacement ? m.displacement->rms : 0.0; }, about);
    add_fit(
        fits, series, "displacement max", theory.finest, step,
        [](const Measurement& m) { return m.displacement ? m.displacement->max : 0.0; }, about);
  }
  const auto parameter = [](const Measurement& m) { return m.what.parameter->value; };
  for (const Series& series : series_of(measurements, "samples")) {
    Fit about;
    about.source = "edges on a regular grid: between -1 (along the grid) and -1.5";
    add_fit(
        fits, series, "colour rmse", 1e9, parameter, [](const Measurement& m) { return m.color_rmse.value_or(0.0); },
        about);
  }
  for (const Series& series : series_of(measurements, "growth")) {
    Fit about;
    about.source = "1: in proportion, 0: does not grow";
    add_fit(
        fits, series, "frame", 1e12, parameter, [](const Measurement& m) { return median(m.frame_ms); }, about);
    add_fit(
        fits, series, "build", 1e12, parameter, [](const Measurement& m) { return m.build_ms(); }, about);
    add_fit(
        fits, series, "memory", 1e12, parameter, [](const Measurement& m) { return static_cast<double>(m.peak_bytes); },
        about);
  }
  return fits;
}

}  // namespace dmvv::bench
