// What a run of the benchmark found, and how it is told: as JSON, as tables, as plots.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/run.h"
#include "bench/start.h"
#include "bench/statistics.h"

namespace dmvv::bench {

/// Where and with what was measured.
struct Machine {
  std::string dmvv;  ///< version
  std::string compiler;
  std::string glslang;
  std::string device;
  std::string device_kind;
  std::string driver;  ///< with its version: "llvmpipe (Mesa 22.3.6 (LLVM 15.0.6))"
  std::string vulkan;
  std::string cpu;
  std::uint32_t cores = 0;
  std::uint64_t memory_bytes = 0;
  std::string system;
  double load = 0.0;  ///< processes that wanted a core in the minute before the run: above 0.5, distrust the times
};
Machine this_machine(const runtime::DeviceInfo& device);

/// A power law through a series, and what theory expects of it.
struct Fit {
  std::string series;    ///< "sphere, r32f, hardware"
  std::string quantity;  ///< "displacement rms", ...
  std::string parameter;
  double from = 0.0, to = 0.0;     ///< of the parameter
  PowerLaw law{};                  ///< quantity = factor * step^exponent, step = 2 / resolution for boundaries
  std::optional<double> expected;  ///< exponent; empty: theory has none
  double tolerance = 0.0;
  std::string source;  ///< of the expectation
  bool holds() const;  ///< true where nothing is expected
};

/// Fits boundaries against the grid's step, colours against samples, times against what grew.
std::vector<Fit> fit_series(const std::vector<Measurement>& measurements);

/// One figure of the stress cases and its bound.
struct StressFigure {
  std::string name;
  std::string what;
  double measured = 0.0;
  double bound = 0.0;
  bool at_least = false;  ///< the bound is what it must not fall below, else what it must not exceed
  std::string unit;
  std::string detail;
  bool held = false;
};

struct Report {
  std::string set;  ///< name of the set, or "scenes"
  bool quick = false;
  double seconds = 0.0;
  Machine machine;
  std::vector<Measurement> measurements;
  std::vector<Missing> missing;
  std::vector<Fit> fits;
  std::vector<StressFigure> stress;
  std::vector<Starts> starts;
};

/// JSON; keys and their order are described in bench/README.md and stay as they are.
std::string to_json(const Report& report);
inline constexpr int schema_version = 5;

/// Tables of at most 100 columns, one a section.
std::string to_table(const Report& report);

/// A plot: the name of its file without ending, and its gnuplot script without terminal and output.
struct Plot {
  std::string name;
  std::string script;
};
/// The plots for which there is something to show.
std::vector<Plot> make_plots(const Report& report);

}  // namespace dmvv::bench
