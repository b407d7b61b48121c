#include "compiler/reference/lint_samples.h"

#include <cmath>

#include "compiler/snippet/probe_points.h"

namespace dmvv::compiler {

namespace {

constexpr int border_samples = 17;  // along each edge of the cube

void include(Extremes& all, double f, const glm::dvec3& p, double t_ms) {
  if (std::isnan(f)) all.any_nan = true;
  if (f < all.least) all.least = f, all.at_least = p, all.least_t_ms = t_ms;
  if (f > all.most) all.most = f, all.at_most = p, all.most_t_ms = t_ms;
}

}  // namespace

const std::vector<glm::dvec3>& border_points() {
  static const std::vector<glm::dvec3> points = [] {
    std::vector<glm::dvec3> result;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        for (int i = 0; i < border_samples * border_samples; ++i) {
          glm::dvec3 p(side);
          const int column = i % border_samples, row = i / border_samples;
          p[(axis + 1) % 3] = 2.0 * column / (border_samples - 1) - 1.0;
          p[(axis + 2) % 3] = 2.0 * row / (border_samples - 1) - 1.0;
          result.push_back(p);
        }
      }
    }
    return result;
  }();
  return points;
}

const std::vector<glm::dvec3>& inner_points() {
  static const std::vector<glm::dvec3> points = [] {
    std::vector<glm::dvec3> result;
    for (std::uint32_t i = 1; i <= 600; ++i) {
      const glm::dvec3 unit(snippet::radical_inverse(i, 2), snippet::radical_inverse(i, 3),
                            snippet::radical_inverse(i, 5));
      result.push_back(unit * 2.0 - 1.0);
    }
    return result;
  }();
  return points;
}

const std::vector<double>& lint_times(bool uses_time) {
  static const std::vector<double> start = {0.0};
  static const std::vector<double> all = [] {
    std::vector<double> times = snippet::probe_times(true);
    for (std::uint32_t i = 1; i <= 24; ++i) times.push_back(20000.0 * snippet::radical_inverse(i, 2));
    return times;
  }();
  return uses_time ? all : start;
}

const Extremes& SampledFunctions::at(Id<Function> function, double t_ms) {
  const auto [place, is_new] = known_.try_emplace({function.index, t_ms});
  if (!is_new) return place->second;
  const snippet::Snippet& snippet = dmvv::at(module_.functions, function).snippet;
  for (const auto* points : {&border_points(), &inner_points()}) {
    for (const glm::dvec3& p : *points) include(place->second, snippet.evaluate(p, t_ms).f, p, t_ms);
  }
  return place->second;
}

void include(Extremes& all, const Extremes& more) {
  include(all, more.least, more.at_least, more.least_t_ms);
  include(all, more.most, more.at_most, more.most_t_ms);
  all.any_nan |= more.any_nan;
}

}  // namespace dmvv::compiler
