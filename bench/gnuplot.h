// Plots are drawn by the program gnuplot, a child process.
#pragma once

#include <string>

#include "bench/report.h"

namespace dmvv::bench {

/// The program's path. Errors (environment): it is not in PATH (names the Debian package).
Result<std::string> find_gnuplot();

/// Draws a plot into a file; its ending chooses: .svg or .png. Errors: environment, with gnuplot's own words.
Result<void> draw(const std::string& gnuplot, const Plot& plot, const std::string& path);

}  // namespace dmvv::bench
