// shaders/sdf.glsl: what its comments promise, measured. A shape is described a second time, by a predicate that says
// what is inside; distances are checked against that by balls that must not, and points that must, cross the surface.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <string>
#include <vector>

#include "compiler/snippet/library.h"
#include "compiler/snippet/snippet.h"

using namespace dmvv;
using compiler::snippet::Snippet;

namespace {

using Inside = std::function<bool(glm::dvec3)>;

Snippet snippet_of(const std::string& expression) {
  voml::Function function;
  function.body.text = "#include <sdf>\nreturn " + expression + ";";
  Diagnostics diagnostics;
  const auto snippet = compiler::snippet::compile_snippet(function, diagnostics);
  REQUIRE_MESSAGE(snippet.has_value(), expression << "\n" << diagnostics.render());
  return *snippet;
}

double eval(const Snippet& snippet, const glm::dvec3& p) { return snippet.evaluate(p, 0.0).f; }

glm::dvec3 gradient(const Snippet& snippet, const glm::dvec3& p) {
  constexpr double h = 1e-6;
  glm::dvec3 result;
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 step(0.0);
    step[i] = h;
    result[i] = (eval(snippet, p + step) - eval(snippet, p - step)) / (2.0 * h);
  }
  return result;
}

/// Uniform in [0, 1), the same in every run.
double uniform() {
  static std::uint64_t state = 7;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return static_cast<double>(state >> 11) * 0x1p-53;
}
glm::dvec3 random_point(double reach) { return (glm::dvec3(uniform(), uniform(), uniform()) * 2.0 - 1.0) * reach; }

std::vector<glm::dvec3> directions() {
  std::vector<glm::dvec3> result;
  constexpr int count = 150;
  for (int i = 0; i < count; ++i) {  // Fibonacci sphere
    const double z = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - z * z), a = 2.399963229728653 * i;
    result.emplace_back(r * std::cos(a), r * std::sin(a), z);
  }
  return result;
}

/// The smallest value of a convex function over [0, 1].
double least(const std::function<double(double)>& f) {
  double lo = 0.0, hi = 1.0;
  for (int i = 0; i < 100; ++i) {
    const double a = lo + (hi - lo) / 3.0, b = hi - (hi - lo) / 3.0;
    (f(a) < f(b) ? hi : lo) = f(a) < f(b) ? b : a;
  }
  return f(0.5 * (lo + hi));
}

double rho(const glm::dvec3& p) { return std::hypot(p.x, p.z); }

struct Shape {
  std::string expression;
  Inside inside;
};

/// Sign as the predicate says; no ball of that radius reaches the other side.
void check_bound(const Shape& shape) {
  CAPTURE(shape.expression);
  const Snippet snippet = snippet_of(shape.expression);
  int wrong_sign = 0, too_far = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 p = random_point(1.5);
    const double d = eval(snippet, p);
    if (std::abs(d) < 1e-5) continue;
    wrong_sign += shape.inside(p) != (d < 0.0);
    for (const glm::dvec3& u : directions()) {
      for (const double share : {0.5, 0.999}) too_far += shape.inside(p + u * (share * std::abs(d))) != (d < 0.0);
    }
  }
  CHECK(wrong_sign == 0);
  CHECK(too_far == 0);
}

/// And a step of that length along the gradient ends at the surface: points beside its end lie on the other side.
void check_exact(const Shape& shape) {
  check_bound(shape);
  CAPTURE(shape.expression);
  const Snippet snippet = snippet_of(shape.expression);
  int too_near = 0, not_unit = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 p = random_point(1.5);
    const double d = eval(snippet, p);
    if (std::abs(d) < 1e-2) continue;
    const glm::dvec3 g = gradient(snippet, p);
    not_unit += std::abs(glm::length(g) - 1.0) > 1e-4;
    const glm::dvec3 foot = p - g * d;
    const auto all = directions();
    too_near += std::none_of(all.begin(), all.end(),
                             [&](const glm::dvec3& u) { return shape.inside(foot + u * 1e-3) != (d < 0.0); });
  }
  CHECK(not_unit == 0);
  CHECK(too_near == 0);
}

/// Neighbouring and distant points: the value never changes faster than `bound`.
double steepest(const Snippet& snippet, double reach = 1.5) {
  double result = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec3 a = random_point(reach), b = a + random_point(i % 2 == 0 ? 0.01 : 0.5);
    result = std::max(result, std::abs(eval(snippet, a) - eval(snippet, b)) / glm::distance(a, b));
  }
  return result;
}

}  // namespace

TEST_CASE("exact shapes are exact") {
  const glm::dvec3 b(0.5, 0.3, 0.7);
  const auto in_box = [](const glm::dvec3& p, const glm::dvec3& half) {
    return std::abs(p.x) < half.x && std::abs(p.y) < half.y && std::abs(p.z) < half.z;
  };
  const glm::dvec3 from(-0.3, -0.4, 0.1), to(0.5, 0.4, -0.2);
  const std::vector<Shape> shapes = {
      {"sd_sphere(p, 0.75)", [](glm::dvec3 p) { return glm::dot(p, p) < 0.5625; }},
      {"sd_plane(p, vec3(0.6, 0.0, 0.8), 0.25)", [](glm::dvec3 p) { return 3.0 * p.x + 4.0 * p.z < 1.25; }},
      {"sd_box(p, vec3(0.5, 0.3, 0.7))", [=](glm::dvec3 p) { return in_box(p, b); }},
      {"sd_round_box(p, vec3(0.5, 0.3, 0.7), 0.125)",
       [=](glm::dvec3 p) { return glm::distance(p, glm::clamp(p, -(b - 0.125), b - 0.125)) < 0.125; }},
      {"sd_torus(p, 0.75, 0.25)",
       [](glm::dvec3 p) { return glm::distance(p, glm::dvec3(p.x, 0, p.z) * (0.75 / rho(p))) < 0.25; }},
      {"sd_capsule(p, vec3(-0.3, -0.4, 0.1), vec3(0.5, 0.4, -0.2), 0.25)",
       [=](glm::dvec3 p) { return least([&](double s) { return glm::distance(p, glm::mix(from, to, s)); }) < 0.25; }},
      {"sd_cylinder(p, 0.5, 0.375)", [](glm::dvec3 p) { return std::abs(p.y) < 0.5 && rho(p) < 0.375; }},
      {"sd_capped_cone(p, 0.5, 0.75, 0.25)",
       [](glm::dvec3 p) { return std::abs(p.y) < 0.5 && rho(p) < 0.5 - 0.5 * p.y; }},
      {"sd_capped_cone(p, 0.25, 0.125, 0.875)",
       [](glm::dvec3 p) { return std::abs(p.y) < 0.25 && rho(p) < 0.5 + 1.5 * p.y; }},
      {"sd_cone(p, 0.75, 0.5)", [](glm::dvec3 p) { return p.y > -0.75 && rho(p) < (0.75 - p.y) / 3.0; }},
      {"sd_round_cone(p, 0.75, 0.5, 0.25)",
       [](glm::dvec3 p) {
         return least([&](double s) { return glm::distance(p, {0, 0.75 * s, 0}) - (0.5 - 0.25 * s); }) < 0.0;
       }},
      {"sd_round_cone(p, 0.75, 0.125, 0.5)",
       [](glm::dvec3 p) {
         return least([&](double s) { return glm::distance(p, {0, 0.75 * s, 0}) - (0.125 + 0.375 * s); }) < 0.0;
       }},
      {"sd_octahedron(p, 0.75)", [](glm::dvec3 p) { return std::abs(p.x) + std::abs(p.y) + std::abs(p.z) < 0.75; }},
      {"sd_hex_prism(p, 0.5, 0.25)",
       [](glm::dvec3 p) {
         bool inside = std::abs(p.y) < 0.25;
         for (int k = 0; k < 3; ++k) {
           inside &= std::abs(p.x * std::sin(k * M_PI / 3.0) + p.z * std::cos(k * M_PI / 3.0)) < 0.5;
         }
         return inside;
       }},
  };
  for (const Shape& shape : shapes) check_exact(shape);
}

TEST_CASE("bounds are bounds, with the right surface") {
  // a regular tetrahedron: its corners, three times as far from the centre as its faces
  const double c = 3.0 * 0.25 / std::sqrt(3.0);
  const std::vector<glm::dvec3> corners = {{-c, -c, -c}, {-c, c, c}, {c, -c, c}, {c, c, -c}};
  const auto in_tetrahedron = [&](glm::dvec3 p) {
    const glm::dmat3 edges(corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]);
    const glm::dvec3 w = glm::inverse(edges) * (p - corners[0]);
    return w.x > 0.0 && w.y > 0.0 && w.z > 0.0 && w.x + w.y + w.z < 1.0;
  };
  const auto gyroid = [](glm::dvec3 p) {
    return std::sin(4 * p.x) * std::cos(4 * p.y) + std::sin(4 * p.y) * std::cos(4 * p.z) +
           std::sin(4 * p.z) * std::cos(4 * p.x);
  };
  const std::vector<Shape> shapes = {
      {"sd_ellipsoid(p, vec3(0.25, 0.5, 1.0))",
       [](glm::dvec3 p) { return 16.0 * p.x * p.x + 4.0 * p.y * p.y + p.z * p.z < 1.0; }},
      {"sd_tetrahedron(p, 0.25)", in_tetrahedron},
      {"sd_gyroid(p, 4.0, 0.0625)", [=](glm::dvec3 p) { return std::abs(gyroid(p)) < 0.0625 * std::sqrt(6.0) * 4.0; }},
      {"op_union(sd_sphere(p, 0.5), sd_box(p, vec3(0.75, 0.25, 0.25)))",
       [](glm::dvec3 p) {
         return glm::length(p) < 0.5 || (std::abs(p.x) < 0.75 && std::abs(p.y) < 0.25 && std::abs(p.z) < 0.25);
       }},
      {"op_intersection(sd_sphere(p, 0.5), sd_plane(p, vec3(0.0, 1.0, 0.0), 0.25))",
       [](glm::dvec3 p) { return glm::length(p) < 0.5 && p.y < 0.25; }},
      {"op_difference(sd_sphere(p, 0.75), sd_sphere(p, 0.5))",
       [](glm::dvec3 p) { return glm::length(p) < 0.75 && glm::length(p) > 0.5; }},
      {"op_onion(sd_sphere(p, 0.5), 0.125)",
       [](glm::dvec3 p) { return glm::length(p) < 0.625 && glm::length(p) > 0.375; }},
  };
  for (const Shape& shape : shapes) check_bound(shape);
}

TEST_CASE("nothing changes faster than its Lipschitz constant") {
  const std::string a = "sd_sphere(p - vec3(0.25, 0.0, 0.0), 0.5)", b = "sd_box(p, vec3(0.25, 0.5, 0.25))";
  struct Limit {
    std::string expression;
    double bound;
  };
  const std::vector<Limit> limits = {
      {"sd_ellipsoid(p, vec3(0.25, 0.5, 1.0))", 1.0},
      {"sd_tetrahedron(p, 0.25)", 1.0},
      {"sd_gyroid(p, 4.0, 0.1)", 1.0},
      {"op_smooth_union(" + a + ", " + b + ", 0.25)", 1.0},
      {"op_smooth_intersection(" + a + ", " + b + ", 0.25)", 1.0},
      {"op_smooth_difference(" + a + ", " + b + ", 0.25)", 1.0},
      {"op_smooth_union_exp(" + a + ", " + b + ", 0.125)", 1.0},
      {"op_round(" + b + ", 0.125)", 1.0},
      {"sd_box(op_elongate(p, vec3(0.25)), vec3(0.25))", 1.0},
      {"sd_sphere(op_repeat(p, vec3(0.75)), 0.25)", 1.0},
      {"sd_sphere(op_repeat_limited(p, vec3(0.75), vec3(1.0, 0.0, 1.0)), 0.25)", 1.0},
      {"sd_box(op_rotate(p, vec3(0.6, 0.0, 0.8), 0.7), vec3(0.25, 0.5, 0.25))", 1.0},
      {"op_noise(p * 4.0)", 4.0 * 6.5},
  };
  for (const Limit& limit : limits) {
    CAPTURE(limit.expression);
    const double found = steepest(snippet_of(limit.expression));
    CHECK(found <= limit.bound * (1.0 + 1e-5));
    CHECK(found > limit.bound * 0.2);  // the measurement sees slopes
  }
}

TEST_CASE("twist and bend keep to the bounds they name, and need them") {
  const double r = 1.5 * std::sqrt(2.0);  // of points in the cube that is sampled
  for (const std::string op : {"twist", "bend"}) {
    for (const double k : {0.5, 2.0, -3.0}) {
      const double bound = eval(snippet_of(fmt::format("op_{}_bound({:f}, {:f})", op, k, r + 0.5)), {});
      const double found = steepest(snippet_of(fmt::format("sd_box(op_{}(p, {:f}), vec3(0.25, 0.5, 0.125))", op, k)));
      CHECK(found <= bound * (1.0 + 1e-5));
      CHECK(found > 1.02);
    }
  }
  CHECK(eval(snippet_of("op_twist_bound(0.0, 1.0)"), {}) == doctest::Approx(1.0));
}

TEST_CASE("smooth operations: values on the seam and away from it") {
  CHECK(eval(snippet_of("op_smooth_union(p.x, p.x, 0.5)"), {0.25, 0, 0}) == doctest::Approx(0.25 - 0.125));
  CHECK(eval(snippet_of("op_smooth_union(p.x, p.y, 0.5)"), {0.25, 0.75, 0}) == doctest::Approx(0.25));
  CHECK(eval(snippet_of("op_smooth_intersection(p.x, p.x, 0.5)"), {0.25, 0, 0}) == doctest::Approx(0.25 + 0.125));
  CHECK(eval(snippet_of("op_smooth_difference(p.x, p.y, 0.5)"), {0.25, -0.25, 0}) == doctest::Approx(0.25 + 0.125));
  CHECK(eval(snippet_of("op_smooth_union_exp(p.x, p.x, 0.5)"), {0.25, 0, 0}) ==
        doctest::Approx(0.25 - 0.5 * std::log(2.0)));
  // three of them in either order
  const glm::dvec3 p(0.1, -0.2, 0.05);
  CHECK(eval(snippet_of("op_smooth_union_exp(op_smooth_union_exp(p.x, p.y, 0.25), p.z, 0.25)"), p) ==
        doctest::Approx(eval(snippet_of("op_smooth_union_exp(p.x, op_smooth_union_exp(p.y, p.z, 0.25), 0.25)"), p)));
}

TEST_CASE("rotations are right-handed and turn the shape") {
  const auto maps = [](const std::string& point, const glm::dvec3& p) {
    return glm::dvec3(eval(snippet_of(point + ".x"), p), eval(snippet_of(point + ".y"), p),
                      eval(snippet_of(point + ".z"), p));
  };
  const std::string quarter = "1.57079632679";
  // a shape at +x that is turned by a quarter around z stands at +y: what is asked there was at +x
  CHECK(glm::distance(maps("op_rotate_z(p, " + quarter + ")", {0, 1, 0}), {1, 0, 0}) < 1e-6);
  CHECK(glm::distance(maps("op_rotate_x(p, " + quarter + ")", {0, 0, 1}), {0, 1, 0}) < 1e-6);
  CHECK(glm::distance(maps("op_rotate_y(p, " + quarter + ")", {1, 0, 0}), {0, 0, 1}) < 1e-6);
  const glm::dvec3 p(0.3, -0.7, 0.2);
  CHECK(glm::distance(maps("op_rotate(p, vec3(0.0, 1.0, 0.0), 0.7)", p), maps("op_rotate_y(p, 0.7)", p)) < 1e-6);
  CHECK(glm::distance(maps("op_rotate(p, vec3(1.0, 0.0, 0.0), 0.7)", p), maps("op_rotate_x(p, 0.7)", p)) < 1e-6);
}

TEST_CASE("repetitions repeat") {
  const Snippet endless = snippet_of("sd_box(op_repeat(p, vec3(0.5, 1.0, 2.0)), vec3(0.1, 0.2, 0.3))");
  const Snippet limited = snippet_of("sd_sphere(op_repeat_limited(p, vec3(0.5), vec3(1.0, 0.0, 0.0)), 0.125)");
  const Snippet polar = snippet_of("sd_sphere(op_repeat_polar(p, 5.0) - vec3(0.75, 0.0, 0.0), 0.2)");
  for (int i = 0; i < 50; ++i) {
    const glm::dvec3 p = random_point(1.0);
    CHECK(eval(endless, p) == doctest::Approx(eval(endless, p + glm::dvec3(1.5, -2.0, 4.0))).epsilon(1e-6));
    const double nearest = std::min({glm::distance(p, {-0.5, 0, 0}), glm::length(p), glm::distance(p, {0.5, 0, 0})});
    CHECK(eval(limited, p) == doctest::Approx(nearest - 0.125).epsilon(1e-6));
    double around = 1e9;
    for (int k = 0; k < 5; ++k) {
      const double angle = 2.0 * M_PI * k / 5.0;
      around = std::min(around, glm::distance(p, {0.75 * std::cos(angle), 0.0, 0.75 * std::sin(angle)}));
    }
    CHECK(eval(polar, p) == doctest::Approx(around - 0.2).epsilon(1e-5));
  }
}

TEST_CASE("an elongated ball is a capsule") {
  const Snippet ball = snippet_of("sd_sphere(op_elongate(p, vec3(0.0, 0.5, 0.0)), 0.25)");
  const Snippet capsule = snippet_of("sd_capsule(p, vec3(0.0, -0.5, 0.0), vec3(0.0, 0.5, 0.0), 0.25)");
  for (int i = 0; i < 50; ++i) {
    const glm::dvec3 p = random_point(1.5);
    CHECK(eval(ball, p) == doctest::Approx(eval(capsule, p)).epsilon(1e-6));
  }
}

TEST_CASE("noise: within its range, continuous across cells, not the same everywhere, no pattern of signs") {
  const Snippet noise = snippet_of("op_noise(p * 8.0)");
  double lo = 1e9, hi = -1e9, sum = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double value = eval(noise, random_point(4.0));
    lo = std::min(lo, value);
    hi = std::max(hi, value);
    sum += value;
  }
  CHECK(lo >= -1.0);
  CHECK(hi <= 1.0);
  CHECK(hi - lo > 1.0);
  CHECK(std::abs(sum / 2000.0) < 0.05);
  for (int i = -8; i <= 8; ++i) {
    const glm::dvec3 border(i / 8.0, 0.3, -0.4), step(1e-9, 0, 0);
    CHECK(eval(noise, border - step) == doctest::Approx(eval(noise, border + step)).epsilon(1e-5));
  }
}

TEST_CASE("every function of the library stands in the table of spec/snippets.md") {
  std::ifstream stream(DMVV_SOURCE_DIR "/spec/snippets.md");
  const std::string spec{std::istreambuf_iterator<char>(stream), {}};
  CHECK(compiler::snippet::library_functions().size() >= 35);
  for (const std::string_view name : compiler::snippet::library_functions()) {
    CAPTURE(name);
    CHECK((name.starts_with("sd_") || name.starts_with("op_")));
    CHECK(spec.find(fmt::format("`{}(", name)) != std::string::npos);
  }
}

TEST_CASE("noise at a point is known to its rounding, on both sides of the origin") {
  const Snippet snippet = snippet_of("op_noise(p)");
  std::size_t known = 0;
  constexpr std::size_t count = 200;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 p = random_point(9.0);
    const auto range = snippet.evaluate({p, p}, {0, 0}, compiler::snippet::Rounding::float32);
    known += range.hi - range.lo < 1e-4 ? 1 : 0;
  }
  CHECK(known == count);
}
