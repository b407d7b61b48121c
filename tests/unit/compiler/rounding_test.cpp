// The bounds of spec/accuracy.md against float32 arithmetic, operation by operation as the shaders do it: how much of a
// bound the worst of many random cases takes. More than all of it is an error; hardly any, and the bound says little.
#include "compiler/ir/rounding.h"
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/gtc/type_precision.hpp>
#include "compiler/grids/sample.h"
#include "compiler/reference/reference.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using compiler::Affine;
using compiler::Approximate;

namespace {

/// shaders/evaluate.glsl, apply.
glm::vec3 apply_float(const Affine& affine, const glm::vec3& p) {
  glm::vec3 q;
  for (int row = 0; row < 3; ++row) {
    const float x = static_cast<float>(affine.linear[0][row]), y = static_cast<float>(affine.linear[1][row]),
                z = static_cast<float>(affine.linear[2][row]), w = static_cast<float>(affine.translation[row]);
    const float xp = x * p.x, yp = y * p.y, zp = z * p.z;
    const float xy = xp + yp, xyz = xy + zp;
    q[row] = xyz + w;
  }
  return q;
}

voml::Transform random_transform(tests::Random& random, double smallest) {
  const auto scale = [&] { return (random.uniform() < 0.2 ? -1.0 : 1.0) * std::pow(smallest, random.uniform()); };
  const double x = scale(), y = scale();
  const glm::dvec3 rotate = random.uniform() < 0.3 ? glm::dvec3(0.0) : random.point(-180, 180);
  return {random.point(-0.9, 0.9), rotate, {x, y, scale()}};
}

double worst_of(const glm::dvec3& ratio) { return std::max({ratio.x, ratio.y, ratio.z}); }

/// A linear filter with exact weights, in float32: a texture of `extent` texels that holds the grid from `slot` on.
float fetch_float(const voml::Grid& grid, const glm::vec3& coordinate, const glm::dvec3& slot,
                  const glm::dvec3& extent) {
  glm::uvec3 lo, hi;
  glm::vec3 w;
  for (int axis = 0; axis < 3; ++axis) {
    const float u = coordinate[axis] * static_cast<float>(extent[axis]) - 0.5f;
    const float base = std::floor(u);
    w[axis] = u - base;
    const auto last = static_cast<double>(grid.size[axis] - 1);
    const double texel = static_cast<double>(base) - slot[axis];  // the border repeats the outer samples
    lo[axis] = static_cast<std::uint32_t>(std::clamp(texel, 0.0, last));
    hi[axis] = static_cast<std::uint32_t>(std::clamp(texel + 1.0, 0.0, last));
  }
  const auto value = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return grid.values[(std::size_t{z} * grid.size.y + y) * grid.size.x + x];
  };
  const auto mix = [](float a, float b, float t) { return a + (b - a) * t; };
  const float v00 = mix(value(lo.x, lo.y, lo.z), value(hi.x, lo.y, lo.z), w.x);
  const float v10 = mix(value(lo.x, hi.y, lo.z), value(hi.x, hi.y, lo.z), w.x);
  const float v01 = mix(value(lo.x, lo.y, hi.z), value(hi.x, lo.y, hi.z), w.x);
  const float v11 = mix(value(lo.x, hi.y, hi.z), value(hi.x, hi.y, hi.z), w.x);
  return mix(mix(v00, v10, w.y), mix(v01, v11, w.y), w.z);
}

compiler::Module one_grid(const voml::Grid& grid) {
  return tests::lowered(
      "<MVV><OBJECT name='A'><SDF name='S' file='g.lxn'/><REGION name='IN' type='color' rgb='1 0 0'/>"
      "</OBJECT></MVV>",
      {{"g.lxn", voml::write_lxn(grid)}});
}

/// The bound that the reference uses at p: the least distance of the value from iso at which it is certain. Found by
/// moving iso; nothing but the grid's decision depends on it.
double decision_bound(compiler::Module& module, const compiler::Reference& reference, const glm::dvec3& p,
                      double value) {
  double lo = 0.0, hi = 1e-9;
  const auto certain = [&](double apart) {
    module.sdfs[0].iso = value + apart;
    return reference.evaluate(p).certain;
  };
  while (!certain(hi) && hi < 1e9) hi *= 2.0;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (lo + hi);
    (certain(middle) ? hi : lo) = middle;
  }
  return hi;
}

}  // namespace

TEST_CASE("rounding: a point carried through frames") {
  tests::Random random(41);
  for (const int levels : {1, 2, 4, 8}) {
    double worst = 0.0;
    for (int round = 0; round < 40000; ++round) {
      const glm::dvec3 p = random.point();
      Approximate at = compiler::rounded(p);
      glm::vec3 q(p);
      for (int level = 0; level < levels; ++level) {
        const Affine affine = compiler::local_from_object(random_transform(random, level % 2 == 0 ? 0.01 : 10.0));
        at = compiler::apply(affine, at);
        q = apply_float(affine, q);
      }
      const glm::dvec3 error = glm::abs(glm::dvec3(q) - at.p);
      worst = std::max({worst, worst_of(error / at.error()), glm::length(error) / at.bound.length});
    }
    MESSAGE(fmt::format("{} frames: {:.2f} of the bound", levels, worst));
    CHECK(worst <= 1.0);
    CHECK(worst > 0.02);
  }
}

TEST_CASE("rounding: transforms themselves, composed in double") {
  // The same way in long double: what double loses is far below what float32 does.
  using Matrix = glm::mat<3, 3, long double>;
  using Vector = glm::vec<3, long double>;
  tests::Random random(43);
  double worst = 0.0;
  for (int round = 0; round < 20000; ++round) {
    Affine composed;
    Matrix linear(1.0L);
    Vector translation(0.0L);
    for (int level = 0; level < 6; ++level) {
      const Affine next = compiler::local_from_object(random_transform(random, 0.1));
      composed = next * composed;
      linear = Matrix(next.linear) * linear;
      translation = Matrix(next.linear) * translation + Vector(next.translation);
    }
    const glm::dvec3 p = random.point();
    const glm::dvec3 error = glm::abs(glm::dvec3(linear * Vector(p) + translation) - composed(p));
    worst = std::max(worst, worst_of(error / compiler::float_error(composed, glm::abs(p))));
  }
  MESSAGE(fmt::format("composing in double: {:.1e} of float32's own error", worst));
  CHECK(worst < 1e-5);
}

TEST_CASE("rounding: a trilinear fetch, and the decision on it") {
  tests::Random random(47);
  double worst = 0.0;
  for (int round = 0; round < 60; ++round) {
    const auto length = [&] { return 2u + static_cast<std::uint32_t>(random.uniform() * 40.0); };
    const std::uint32_t nx = length(), ny = length();
    const double size = std::pow(10.0, random.in(-3, 3)), rough = random.uniform();
    voml::Grid grid = tests::grid_of(
        {nx, ny, length()}, [&](glm::dvec3 p) { return size * (glm::length(p) - 0.7 + rough * random.in(-1.0, 1.0)); });
    compiler::Module module = one_grid(grid);
    const compiler::Reference reference(module);
    // Somewhere in a full atlas; the compiler's own slot is at its beginning, where coordinates are finest.
    const glm::dvec3 extent(2048.0, 2048.0, 2048.0), slot = glm::floor(random.point(1.0, 2000.0));
    for (int point = 0; point < 300; ++point) {
      const glm::dvec3 p(glm::vec3(random.point(-0.999, 0.999)));
      glm::vec3 coordinate;
      for (int axis = 0; axis < 3; ++axis) {
        const double scale = 0.5 * grid.size[axis] / extent[axis];
        const double offset = (slot[axis] + 0.5 * grid.size[axis]) / extent[axis];
        const float scaled = static_cast<float>(scale) * static_cast<float>(p[axis]);
        coordinate[axis] = scaled + static_cast<float>(offset);
      }
      const double value = compiler::sample(grid, p);
      const double error = std::abs(static_cast<double>(fetch_float(grid, coordinate, slot, extent)) - value);
      worst = std::max(worst, error / decision_bound(module, reference, p, value));
    }
  }
  MESSAGE(fmt::format("fetch and decision: {:.2f} of the bound", worst));
  CHECK(worst <= 1.0);
  CHECK(worst > 0.02);
}

TEST_CASE("rounding: wrapping into a cube of a tiling") {
  tests::Random random(53);
  double worst = 0.0;
  for (int round = 0; round < 200000; ++round) {
    const double q = random.in(-1.0, 1.0) * std::pow(10.0, random.in(0.0, 5.0));
    const float f = static_cast<float>(q);
    const float turns = (f + 1.0f) * 0.5f, whole = 2.0f * std::floor(turns);
    const double exact = q - 2.0 * std::floor((q + 1.0) * 0.5),
                 error = std::abs(static_cast<double>(f - whole) - exact);
    const double bound = compiler::float_unit * std::abs(q) + 4.0 * compiler::float_unit * (std::abs(q) + 1.0);
    const double to_seam = std::abs((q + 1.0) * 0.5 - std::round((q + 1.0) * 0.5)) * 2.0;
    if (to_seam > bound) worst = std::max(worst, error / bound);
  }
  MESSAGE(fmt::format("wrapping: {:.2f} of the bound", worst));
  CHECK(worst <= 1.0);
  CHECK(worst > 0.02);
}
