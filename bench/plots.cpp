#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/report.h"
#include "bench/text_table.h"

namespace dmvv::bench {
namespace {

/// Distinct also for most of the colour-blind (Okabe and Ito 2008), and marked by shape as well.
constexpr std::array colors{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f"};
constexpr std::array marks{7, 5, 9, 11, 13, 6, 4, 8};

struct Mark {
  double x, y;
  std::string label;
};

struct Line {
  std::string title;
  std::vector<Mark> marks;
};

bool drawable(const Mark& mark) {
  return std::isfinite(mark.x) && std::isfinite(mark.y) && mark.x > 0.0 && mark.y > 0.0;
}

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

/// A block of "x y label" lines that plots refer to as $name.
std::string data(const std::string& name, const std::vector<Mark>& marks_of) {
  std::string text = fmt::format("${} << EOD\n", name);
  for (const Mark& mark : marks_of) {
    if (drawable(mark)) text += fmt::format("{:.7g} {:.7g} \"{}\"\n", mark.x, mark.y, mark.label);
  }
  return text + "EOD\n";
}

std::string style(std::size_t i) {
  return fmt::format("lc rgb '{}' pt {} ps 0.8 lw 2", colors[i % colors.size()], marks[i % marks.size()]);
}

/// Limits that leave room around the marks on a logarithmic axis.
std::string range(const std::vector<Line>& lines, double Mark::*coordinate) {
  double lo = 1e300, hi = 0.0;
  for (const Line& line : lines) {
    for (const Mark& mark : line.marks) {
      if (!drawable(mark)) continue;
      lo = std::min(lo, mark.*coordinate);
      hi = std::max(hi, mark.*coordinate);
    }
  }
  const double room = std::max(1.15, std::pow(hi / lo, 0.08));
  return fmt::format("[{:.4g}:{:.4g}]", lo / room, hi * room);
}

/// Labels at some digits of each power of ten, the more the fewer powers there are; beyond a few gnuplot's own.
std::string ticks(const char* axis, const std::vector<Line>& lines, double Mark::*coordinate) {
  double lo = 1e300, hi = 0.0;
  for (const Line& line : lines) {
    for (const Mark& mark : line.marks) {
      if (!drawable(mark)) continue;
      lo = std::min(lo, mark.*coordinate);
      hi = std::max(hi, mark.*coordinate);
    }
  }
  if (hi / lo > 300.0) return {};
  const std::vector<int> digits = hi / lo < 12.0 ? std::vector<int>{1, 2, 3, 5, 7} : std::vector<int>{1, 2, 5};
  std::string list;
  for (int power = static_cast<int>(std::floor(std::log10(lo))) - 1; power <= std::ceil(std::log10(hi)); ++power) {
    for (const int digit : digits) list += fmt::format("{}{}e{}", list.empty() ? "" : ", ", digit, power);
  }
  return fmt::format("set {}tics ({})\n", axis, list);
}

std::string axes(const std::string& title, const std::string& x, const std::string& y) {
  return fmt::format(
      "set title {}\nset xlabel {}\nset ylabel {}\nset grid lc rgb '#dddddd' lw 1\nset border 3\nset tics nomirror\n"
      "set logscale xy\nset key outside right top Left reverse samplen 2 spacing 1.2\nset format y '%.0e'\n",
      quoted(title), quoted(x), quoted(y));
}

/// Lines with marks; `more` are further plot elements, each after a comma.
std::string line_plot(const std::vector<Line>& lines, const std::string& x_ticks, const std::string& more = {}) {
  std::string script = fmt::format("set xrange {}\nset yrange {}\n", range(lines, &Mark::x), range(lines, &Mark::y));
  script += ticks("y", lines, &Mark::y) + x_ticks;
  for (std::size_t i = 0; i < lines.size(); ++i) script += data(fmt::format("line{}", i), lines[i].marks);
  script += "plot ";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    script += fmt::format("{}$line{} using 1:2 with linespoints {} title {}", i == 0 ? "" : ", \\\n  ", i, style(i),
                          quoted(lines[i].title));
  }
  return script + more + "\n";
}

/// The lines of a section's series, one a variant, in the order of the measurements.
template <class X, class Y>
std::vector<Line> lines_of(const Report& report, const std::string& section, const std::string& series, X x_of,
                           Y y_of) {
  std::vector<Line> lines;
  for (const Measurement& m : report.measurements) {
    if (m.what.section != section || m.what.series != series || !m.failure.empty()) continue;
    auto line = std::ranges::find(lines, m.what.variant, &Line::title);
    if (line == lines.end()) line = lines.insert(lines.end(), Line{m.what.variant, {}});
    line->marks.push_back({x_of(m), y_of(m), m.what.parameter ? fmt::format("{:.0f}", m.what.parameter->value) : ""});
  }
  std::erase_if(lines, [](const Line& line) { return std::ranges::none_of(line.marks, drawable); });
  return lines;
}

std::vector<std::string> series_names(const Report& report, const std::string& section) {
  std::vector<std::string> names;
  for (const Measurement& m : report.measurements) {
    if (m.what.section == section && m.failure.empty() && std::ranges::find(names, m.what.series) == names.end()) {
      names.push_back(m.what.series);
    }
  }
  return names;
}

std::string file_name(std::string name) {
  std::ranges::replace(name, ' ', '_');
  return name;
}

double rms(const Measurement& m) { return m.displacement ? m.displacement->rms : 0.0; }
double parameter(const Measurement& m) { return m.what.parameter ? m.what.parameter->value : 0.0; }

/// Renames "auto", which in these plots stands for the default atlas and filter.
std::vector<Line> with_default_named(std::vector<Line> lines) {
  for (Line& line : lines) {
    if (line.title == "auto") line.title = "default (r32f, hardware)";
    if (line.title == "table" || line.title == "thesis") line.title += " codegen";
  }
  return lines;
}

void convergence(const Report& report, std::vector<Plot>& plots) {
  for (const std::string& shape : series_names(report, "boundary")) {
    const auto lines = with_default_named(lines_of(report, "boundary", shape, parameter, rms));
    if (lines.empty() || lines.front().marks.size() < 2) continue;
    const Mark& first = lines.front().marks.front();
    const double factor = first.y * first.x * first.x;
    std::string script = axes(fmt::format("Boundary of a {}: error against resolution", shape),
                              "samples of the grid along a side", "displacement RMS, object units (cube: -1..1)");
    script +=
        line_plot(lines, "set xtics (16, 32, 64, 128, 256)\n",
                  fmt::format(", \\\n  {:.6g}/(x*x) with lines lc rgb '#999999' dt 2 lw 1.5 title 'h^2 (theory)', \\\n "
                              " 0.0236/x with lines lc rgb '#999999' dt 3 lw 1.5 title '8 bits: 1.2 % of h at most'",
                              0.6 * factor));
    plots.push_back({"convergence_" + file_name(shape), script});
  }
}

/// Marks of all lines, and the front that nothing beats.
std::string with_front(const std::vector<Line>& lines, const std::string& label_of_front) {
  std::vector<CostError> points;
  std::vector<const Mark*> all;
  for (const Line& line : lines) {
    for (const Mark& mark : line.marks) {
      if (!drawable(mark)) continue;
      points.push_back({mark.x, mark.y});
      all.push_back(&mark);
    }
  }
  std::vector<Mark> front;
  for (const std::size_t i : pareto_front(points)) {
    Mark mark = *all[i];
    const bool crowded = !front.empty() && mark.x < 1.1 * front.back().x && mark.y > front.back().y / 1.5;
    if (crowded) mark.label.clear();
    front.push_back(std::move(mark));
  }
  std::string script = fmt::format("set xrange {}\nset yrange {}\n", range(lines, &Mark::x), range(lines, &Mark::y));
  script += ticks("x", lines, &Mark::x) + ticks("y", lines, &Mark::y);
  script += data("front", front);
  for (std::size_t i = 0; i < lines.size(); ++i) script += data(fmt::format("line{}", i), lines[i].marks);
  script += "plot $front using 1:2 with steps lc rgb '#444444' dt 2 lw 1.5 title 'Pareto front'";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    script += fmt::format(", \\\n  $line{} using 1:2 with points {} title {}", i, style(i), quoted(lines[i].title));
  }
  return script + fmt::format(", \\\n  $front using 1:2:3 with labels offset 0.6,0.7 left font ',10' title {}\n",
                              quoted(label_of_front));
}

void error_against_time(const Report& report, std::vector<Plot>& plots) {
  const auto cost = [](const Measurement& m) { return median(m.point_ns); };
  for (const std::string& shape : series_names(report, "boundary")) {
    const auto lines = with_default_named(lines_of(report, "boundary", shape, cost, rms));
    if (lines.empty()) continue;
    plots.push_back({"error_time_" + file_name(shape), axes(fmt::format("Boundary of a {}: error against time", shape),
                                                            "one evaluation, ns", "displacement RMS, object units") +
                                                           "set format x '%g'\n" +
                                                           with_front(lines, "label: samples a side")});
  }
  std::vector<Line> samples = lines_of(
      report, "samples", "samples", [](const Measurement& m) { return median(m.frame_ms); },
      [](const Measurement& m) { return m.color_rmse.value_or(0.0); });
  if (samples.empty()) return;
  samples.front().title = "n x n samples a pixel";
  plots.push_back(
      {"error_time_samples", axes("A slice through 1,000 objects: colour error against time",
                                  "frame of 192 x 192 pixels, ms", "colour RMSE (0..1) to the converged picture") +
                                 "set format x '%g'\nset format y '%g'\n" + with_front(samples, "label: n")});
}

void growth(const Report& report, std::vector<Plot>& plots) {
  for (const std::string& series : series_names(report, "growth")) {
    std::vector<Line> lines;
    const auto take = [&](const char* what, const auto& y_of) {
      for (Line& line : lines_of(report, "growth", series, parameter, y_of)) {
        line.title = fmt::format("{}, {}", what, line.title);
        lines.push_back(std::move(line));
      }
    };
    take("build", [](const Measurement& m) { return m.build_ms(); });
    take("frame", [](const Measurement& m) { return median(m.frame_ms); });
    if (lines.empty() || lines.front().marks.size() < 2) continue;
    const auto first = std::ranges::find_if(report.measurements, [&](const Measurement& m) {
      return m.what.section == "growth" && m.what.series == series && m.failure.empty();
    });
    plots.push_back({"growth_" + file_name(series),
                     axes(fmt::format("Growth: {}", series), first->what.parameter->name, "ms") +
                         "set format x '%g'\nset format y '%g'\n" + line_plot(lines, ticks("x", lines, &Mark::x))});
  }
}

/// Frames of a scene with every setting, as bars; beside each the share of wrong pixels.
void settings_bars(const Report& report, std::vector<Plot>& plots) {
  for (const std::string& scene : series_names(report, "scene")) {
    std::string rows;
    std::size_t count = 0;
    glm::uvec2 size_px{0};
    for (const Measurement& m : report.measurements) {
      if (m.what.section != "scene" || m.what.series != scene || !m.failure.empty()) continue;
      const std::string wrong = m.pixels ? fmt::format("wrong {}", number(m.pixels->wrong_fraction())) : "";
      size_px = m.what.size_px;
      rows += fmt::format("{} {:.6g} \"{}\" \"  {} ms, {}\"\n", count++, median(m.frame_ms), m.what.variant,
                          number(median(m.frame_ms)), wrong);
    }
    if (count < 2) continue;
    std::string script = fmt::format(
        "set title {}\nset xlabel 'frame of {} x {} pixels, ms'\nset border 3\nset tics nomirror\nunset key\n"
        "set grid x lc rgb '#dddddd' lw 1\nset xrange [0:*]\nset yrange [{}:-0.7]\nset rmargin 24\n",
        quoted(fmt::format("{}: frame time and wrong pixels by setting", scene)), size_px.x, size_px.y,
        static_cast<double>(count) - 0.3);
    script += "$rows << EOD\n" + rows + "EOD\n";
    script +=
        "plot $rows using 2:1:(0):2:($1-0.35):($1+0.35):ytic(3) with boxxyerror fs solid 0.6 noborder lc rgb "
        "'#0072b2', \\\n"
        "  $rows using 2:1:4 with labels left font ',10'\n";
    plots.push_back({"settings_" + file_name(scene), script});
  }
}

}  // namespace

std::vector<Plot> make_plots(const Report& report) {
  std::vector<Plot> plots;
  convergence(report, plots);
  error_against_time(report, plots);
  growth(report, plots);
  settings_bars(report, plots);
  return plots;
}

}  // namespace dmvv::bench
