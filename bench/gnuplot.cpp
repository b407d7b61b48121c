#include "bench/gnuplot.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>
#include <system_error>

#include "base/files.h"
#include "bench/process.h"

namespace dmvv::bench {
namespace {

namespace fs = std::filesystem;

std::string preamble(const std::string& path) {
  const bool is_png = path.ends_with(".png");
  std::string quoted_path;
  for (const char c : path) quoted_path += c == '\'' ? std::string("''") : std::string(1, c);
  return fmt::format(
      "set encoding utf8\nset terminal {} size 900,520 noenhanced font 'DejaVu Sans,{}' background '#ffffff'\nset "
      "output '{}'\n",
      is_png ? "pngcairo" : "svg", is_png ? 11 : 13, quoted_path);
}

/// A file that is removed when it goes out of scope.
struct Temporary {
  std::string path;
  ~Temporary() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
};

}  // namespace

Result<std::string> find_gnuplot() {
  if (auto program = find_program("gnuplot")) return std::move(*program);
  return fail(Fault::environment, "plots are drawn by the program gnuplot, which is not there",
              {"install it: apt-get install gnuplot-nox", "or leave --plots out: --json has every figure"});
}

Result<void> draw(const std::string& gnuplot, const Plot& plot, const std::string& path) {
  const Temporary script{path + ".gp"}, log{path + ".log"};
  if (auto written = write_file(script.path, preamble(path) + plot.script); !written) return written;

  const auto is_drawn = run_program({gnuplot, script.path}, environment_variables(), log.path);
  if (!is_drawn) return tl::unexpected(is_drawn.error());
  if (*is_drawn) return {};
  Error failure{Fault::environment, fmt::format("gnuplot could not draw '{}'", plot.name), {}};
  std::istringstream lines(disk_files()(log.path, 1 << 20).value_or(""));
  for (std::string line; failure.reasons.size() < 10 && std::getline(lines, line);)
    failure.reasons.push_back("gnuplot: " + line);
  return tl::unexpected(std::move(failure));
}

}  // namespace dmvv::bench
