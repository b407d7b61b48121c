#include "compiler/snippet/probe_points.h"

#include <fmt/format.h>

namespace dmvv::compiler::snippet {

double radical_inverse(std::uint32_t index, std::uint32_t base) {
  double result = 0.0;
  for (double digit = 1.0 / base; index != 0; index /= base, digit /= base) result += (index % base) * digit;
  return result;
}

const std::vector<glm::dvec3>& probe_points() {
  static const std::vector<glm::dvec3> points = [] {
    constexpr std::uint32_t inner = 64;
    std::vector<glm::dvec3> result = {{0, 0, 0}};
    for (int i = 0; i < 8; ++i) result.emplace_back((i & 1) * 2 - 1, (i >> 1 & 1) * 2 - 1, (i >> 2 & 1) * 2 - 1);
    for (std::uint32_t i = 1; i <= inner; ++i) {
      result.push_back(glm::dvec3(radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5)) * 2.0 - 1.0);
    }
    return result;
  }();
  return points;
}

const std::vector<double>& probe_times(bool uses_time) {
  static const std::vector<double> start = {0.0};
  static const std::vector<double> all = {0.0, 1.0, 16.7, 1000.0, 60000.0, 3.6e6};
  return uses_time ? all : start;
}

std::string describe(const glm::dvec3& p, double t_ms, bool uses_time) {
  const std::string point = fmt::format("p = ({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
  return uses_time ? fmt::format("{}, t = {} ms", point, t_ms) : point;
}

}  // namespace dmvv::compiler::snippet
