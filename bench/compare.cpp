#include "bench/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/report.h"
#include "bench/statistics.h"
#include "bench/text_table.h"

namespace dmvv::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t enough_samples = 5;
constexpr std::size_t enough_pairs = 3;
constexpr double sigmas = 4.0;  // hundreds of figures are judged at once

/// A timed figure: samples, or nothing.
struct Timed {
  std::string name;
  std::vector<double> samples;
  double negligible;  ///< differences that are never called out
};

std::vector<double> samples_at(const Json& summary) {
  return summary.is_object() ? summary.at("samples").get<std::vector<double>>() : std::vector<double>{};
}

std::vector<Timed> timed_figures(const Json& run) {
  std::vector<Timed> figures;
  for (const auto& [step, summary] : run.at("times_ms").items()) figures.push_back({step, samples_at(summary), 0.05});
  figures.push_back({"point", samples_at(run.at("point_ns")), 0.2});
  return figures;
}

/// A figure of error: the less the better.
struct Wrong {
  std::string name;
  double value;
  double relative, absolute;  ///< a rise within these is none
};

std::vector<Wrong> error_figures(const Json& run) {
  const Json& errors = run.at("errors");
  std::vector<Wrong> figures;
  for (const char* kind : {"points", "pixels"}) {
    if (errors.at(kind).is_object()) {
      figures.push_back({fmt::format("wrong {}", kind), errors.at(kind).at("wrong_fraction").get<double>(), 0.0, 0.0});
    }
  }
  if (errors.at("colour_rmse").is_number())
    figures.push_back({"colour rmse", errors.at("colour_rmse").get<double>(), 0.01, 1e-7});
  const Json& moved = errors.at("displacement");
  if (moved.is_object()) {
    figures.push_back({"displacement", moved.at("rms").get<double>(), 0.01, 1e-7});
    figures.push_back({"lost boundary", moved.at("lost").get<double>(), 0.0, 0.0});
  }
  return figures;
}

const Json* find_run(const Json& result, const std::string& id) {
  for (const Json& run : result.at("runs")) {
    if (run.at("id") == id && run.at("failure").is_null()) return &run;
  }
  return nullptr;
}

template <class Figures>
auto find_figure(const Figures& figures, const std::string& name) {
  return std::ranges::find_if(figures, [&](const auto& figure) { return figure.name == name; });
}

using SamplePairs = std::vector<std::pair<std::vector<double>, std::vector<double>>>;

/// Standard error of the mean ratio that the scatter within the runs gives reason to expect. A few ratios that agree by
/// chance must not pass for precision.
double error_within(const SamplePairs& pairs) {
  double squares = 0.0;
  for (const auto& [before, after] : pairs) {
    const double ratio = median(after) / median(before);
    squares +=
        std::pow(median_error(before) / median(before) * ratio, 2) + std::pow(median_error(after) / median(before), 2);
  }
  return std::sqrt(squares) / static_cast<double>(pairs.size());
}

/// The verdict on one timed figure over all pairs that have it.
Change judge_time(std::string id, const Timed& name, const SamplePairs& pairs) {
  Change change;
  change.id = std::move(id);
  change.figure = name.name;
  change.before = median(pairs.front().first);
  change.after = median(pairs.front().second);
  std::vector<double> ratios;
  for (const auto& [before, after] : pairs) ratios.push_back(median(after) / median(before));
  change.ratio = median(ratios);
  if (pairs.size() >= enough_pairs) {
    change.noise = std::max({0.03, sigmas * median_error(ratios), sigmas * error_within(pairs)});
  } else {
    const auto& [before, after] = pairs.front();
    const bool weak = std::min(before.size(), after.size()) < enough_samples;
    change.noise = weak ? 0.3 : std::max(0.05, sigmas * error_within({pairs.front()}));
  }
  const bool negligible = std::abs(change.after - change.before) < name.negligible;
  if (!negligible && change.ratio > 1.0 + change.noise) change.verdict = Verdict::slower;
  if (!negligible && change.ratio < 1.0 / (1.0 + change.noise)) change.verdict = Verdict::faster;
  return change;
}

Change judge_error(std::string id, const Wrong& before, const Wrong& after) {
  Change change{std::move(id),   before.name,  before.value, after.value, after.value / before.value,
                before.relative, Verdict::same};
  if (before.value == 0.0) change.ratio = after.value == 0.0 ? 1.0 : INFINITY;
  const double rise = after.value - before.value;
  if (rise > before.relative * before.value + before.absolute) change.verdict = Verdict::more_wrong;
  if (-rise > before.relative * before.value + before.absolute) change.verdict = Verdict::less_wrong;
  return change;
}

void compare_run(const std::vector<std::pair<const Json*, const Json*>>& runs, Comparison& comparison) {
  const std::string id = runs.front().first->at("id");
  for (const Timed& figure : timed_figures(*runs.front().first)) {
    SamplePairs pairs;
    for (const auto& [before, after] : runs) {
      const auto a = timed_figures(*before), b = timed_figures(*after);
      const auto in_a = find_figure(a, figure.name), in_b = find_figure(b, figure.name);
      if (in_a != a.end() && in_b != b.end() && !in_a->samples.empty() && !in_b->samples.empty()) {
        pairs.emplace_back(in_a->samples, in_b->samples);
      }
    }
    if (!pairs.empty()) comparison.changes.push_back(judge_time(id, figure, pairs));
  }
  const auto after = error_figures(*runs.front().second);
  for (const Wrong& figure : error_figures(*runs.front().first)) {
    const auto same = find_figure(after, figure.name);
    if (same != after.end()) comparison.changes.push_back(judge_error(id, figure, *same));
  }
}

Comparison compare_results(const std::vector<std::pair<Json, Json>>& results) {
  Comparison comparison;
  const auto& [first, second] = results.front();
  for (const auto& [key, value] : first.at("machine").items()) {
    if (key == "load" || second.at("machine").at(key) == value) continue;
    comparison.notes.push_back(
        fmt::format("{}: {} before, {} after", key, value.dump(), second.at("machine").at(key).dump()));
  }
  for (const Json& run : first.at("runs")) {
    const std::string id = run.at("id");
    std::vector<std::pair<const Json*, const Json*>> runs;
    for (const auto& [before, after] : results) {
      const Json *a = find_run(before, id), *b = find_run(after, id);
      if (a != nullptr && b != nullptr) runs.emplace_back(a, b);
    }
    if (!runs.empty()) {
      compare_run(runs, comparison);
    } else if (find_run(first, id) != nullptr) {
      comparison.only_before.push_back(id);
    }
  }
  for (const Json& run : second.at("runs")) {
    const std::string id = run.at("id");
    if (run.at("failure").is_null() && find_run(first, id) == nullptr) comparison.only_after.push_back(id);
  }
  return comparison;
}

std::string called_out(const Comparison& comparison, Verdict verdict, const std::string& title) {
  std::vector<Change> chosen;
  std::ranges::copy_if(comparison.changes, std::back_inserter(chosen),
                       [&](const Change& c) { return c.verdict == verdict; });
  std::ranges::stable_sort(chosen, std::greater{}, [](const Change& c) { return std::max(c.ratio, 1.0 / c.ratio); });
  TextTable table({"case", "figure", "before", "after", "ratio", "noise"}, {"", "", "", "", "", "+-"});
  for (const Change& c : chosen) {
    table.add({c.id, c.figure, number(c.before), number(c.after), fmt::format("{:.2f}", c.ratio),
               fmt::format("{:.0f} %", 100 * c.noise)});
  }
  return table.empty() ? fmt::format("{}: nothing\n", title)
                       : fmt::format("{}: {}\n{}", title, chosen.size(), table.text());
}

/// Geometric means of the ratios, a line a figure.
std::string means(const Comparison& comparison) {
  std::vector<std::string> names;
  std::map<std::string, std::pair<double, int>> sums;
  for (const Change& c : comparison.changes) {
    if (!(c.ratio > 0.0) || !std::isfinite(c.ratio) || c.verdict == Verdict::more_wrong ||
        c.verdict == Verdict::less_wrong)
      continue;
    if (c.figure.starts_with("wrong") || c.figure == "colour rmse" || c.figure == "displacement" ||
        c.figure == "lost boundary")
      continue;
    if (!sums.contains(c.figure)) names.push_back(c.figure);
    sums[c.figure].first += std::log(c.ratio);
    ++sums[c.figure].second;
  }
  TextTable table({"ratio of times, all cases", "mean", "cases"}, {"", "", ""});
  for (const std::string& name : names) {
    const auto& [sum, count] = sums[name];
    table.add({name, fmt::format("{:.3f}", std::exp(sum / count)), fmt::format("{}", count)});
  }
  return table.empty() ? "" : table.text() + '\n';
}

}  // namespace

bool Comparison::worse() const {
  return std::ranges::any_of(
      changes, [](const Change& c) { return c.verdict == Verdict::slower || c.verdict == Verdict::more_wrong; });
}

Result<Comparison> compare(const std::vector<std::pair<std::string, std::string>>& pairs) {
  if (pairs.empty()) return fail(Fault::input, "there is no pair of results to compare");
  std::vector<std::pair<Json, Json>> results;
  for (const auto& [before, after] : pairs) {
    results.emplace_back(Json::parse(before, nullptr, false), Json::parse(after, nullptr, false));
    for (const Json* json : {&results.back().first, &results.back().second}) {
      if (!json->is_object() || !json->contains("schema") || (*json)["schema"] != schema_version) {
        return fail(Fault::input, fmt::format("not a result of dmvv bench with schema {}", schema_version));
      }
    }
  }
  try {
    return compare_results(results);
  } catch (const Json::exception& error) {
    return fail(Fault::input, "a result of dmvv bench lacks something", {error.what()});
  }
}

std::string to_text(const Comparison& comparison) {
  std::string text;
  for (const std::string& note : comparison.notes) text += fmt::format("differs: {}\n", note);
  text += means(comparison);
  text += called_out(comparison, Verdict::more_wrong, "More wrong");
  text += called_out(comparison, Verdict::slower, "Slower");
  text += called_out(comparison, Verdict::less_wrong, "Less wrong");
  text += called_out(comparison, Verdict::faster, "Faster");
  const auto same = std::ranges::count(comparison.changes, Verdict::same, &Change::verdict);
  text += fmt::format("Within the noise: {} of {} figures\n", same, comparison.changes.size());
  for (const std::string& id : comparison.only_before) text += fmt::format("only before: {}\n", id);
  for (const std::string& id : comparison.only_after) text += fmt::format("only after: {}\n", id);
  return text;
}

}  // namespace dmvv::bench
