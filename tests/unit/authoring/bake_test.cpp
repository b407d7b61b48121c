#include "authoring/bake.h"

#include <random>

#include "compiler/reference/reference.h"
#include "tests/unit/authoring/scene_fields.h"
#include "tests/unit/authoring/shapes.h"

namespace dmvv::tests {

namespace {

using authoring::BakeOptions;
using authoring::BakeReport;
using authoring::Field;

class Random {
 public:
  double number(double lo, double hi) { return lo + (hi - lo) * (random_() / 4294967296.0); }
  dvec3 point(double extent) {
    const double x = number(-extent, extent), y = number(-extent, extent), z = number(-extent, extent);
    return {x, y, z};
  }

 private:
  std::mt19937 random_{11};
};

voml::Grid bake(const Field& field, const BakeOptions& options, BakeReport* report = nullptr) {
  BakeReport own;
  auto grid = authoring::bake(field, options, report == nullptr ? own : *report);
  REQUIRE(grid.has_value());
  REQUIRE(grid->values.size() == std::size_t{grid->size.x} * grid->size.y * grid->size.z);
  return std::move(*grid);
}

double voxel_of(const voml::Grid& grid) { return (grid.box_hi.x - grid.box_lo.x) / grid.size.x; }

/// A grid of 12 x 12 x 12 over a box: a ball of radius 0.7 about (0.2, 0, 0), which the box cuts.
std::string cut_ball() {
  voml::Grid grid;
  grid.size = glm::uvec3(12);
  grid.box_lo = dvec3(-0.75, -0.5, -1.0);
  grid.box_hi = dvec3(0.5, 0.75, 0.5);
  grid.values.resize(12 * 12 * 12);
  std::size_t i = 0;
  for_each_sample(grid, [&](const dvec3& p, double) {
    grid.values[i++] = static_cast<float>(glm::length(p - dvec3(0.2, 0, 0)) - 0.7);
  });
  return voml::write_lxn(grid);
}

}  // namespace

TEST_CASE("a field is not positive exactly where the scene's reference decides for the negative side") {
  const std::map<std::string, std::string> files{
      {"ball.lxn", cut_ball()},
      {"few.txt", "0.1 0 0\n-0.2 0.1 0\n"},
      {"many.txt",
       "0.1 0 0\n-0.2 0.1 0\n0.3 0.3 0.3\n-0.3 -0.3 0.1\n0 0 0\n0.4 -0.4 0\n0.1 0.2 -0.4\n-0.4 0 0.4\n0 -0.3 0.3\n"},
      {"turns.txt", "0 0 0\n10 20 30\n0 90 0\n45 0 0\n5 5 5\n0 0 45\n1 2 3\n80 70 60\n33 0 0\n"}};
  const std::string sdfs[] = {
      function("return length(p) - 0.5;"),
      function("return length(p) - 0.5;",
               "offset=\"0.2\" translate=\"0.1 0 0.2\" rotate=\"10 20 30\" scale=\"0.5 1 1.5\""),
      function("return p.y - 0.3 * p.x;", "scale=\"0.4 0.5 0.6\" rotate=\"0 30 0\""),  // its box cuts it
      function("return length(p) - 1.2;", "type=\"seeding\" seedFile=\"few.txt\" scale=\"0.3 0.3 0.3\""),
      function("return length(p) - 1.1;",
               "type=\"seeding\" seedFile=\"many.txt\" rotateFile=\"turns.txt\" scale=\"0.2 0.3 0.1\""),
      function("return length(p) - 0.7;", "type=\"tiling\" scale=\"0.3 0.25 0.2\" rotate=\"0 0 20\""),
      function("return p.x < 0.0 ? 0.0 / p.z * 0.0 : -1.0;"),  // NaN on one side
      "<SDF name=\"F\" file=\"ball.lxn\"/>",
      "<SDF name=\"F\" file=\"ball.lxn\" offset=\"-0.1\" rotate=\"30 0 0\" scale=\"0.5 0.5 0.5\"/>",
      "<SDF name=\"F\" file=\"ball.lxn\" type=\"tiling\" scale=\"0.5 0.5 0.5\"/>",
      "<SDF name=\"F\" file=\"ball.lxn\" type=\"seeding\" seedFile=\"many.txt\" scale=\"0.3 0.3 0.3\"/>"};
  Random random;
  for (const std::string& sdf : sdfs) {
    CAPTURE(sdf);
    const compiler::Module module = module_of(scene_of(sdf), files);
    const compiler::Reference reference(module);
    const Field field = field_of(module);
    const auto box = field.inside();
    REQUIRE(box);
    std::size_t inside = 0, wrong = 0, outside_box = 0, jumps = 0;
    for (int i = 0; i < 20000; ++i) {
      const dvec3 p = random.point(1.0);
      const auto answer = reference.evaluate(p);
      if (!answer.certain) continue;
      const bool negative = answer.number != 0;
      inside += negative;
      wrong += (field(p) <= 0.0) != negative;
      outside_box += negative && (glm::any(glm::lessThan(p, box->lo)) || glm::any(glm::greaterThan(p, box->hi)));
      // Next to the boundary a field is small, whatever the boundary is: an SDF's own or a face of its box.
      const dvec3 q = p + 1e-6 * random.point(1.0);
      jumps += (field(q) <= 0.0) != negative && std::abs(field(p)) > 1e-3;
    }
    CHECK(inside > 200);
    CHECK(wrong == 0);
    CHECK(outside_box == 0);
    if (sdf.find("0.0 / p.z") == std::string::npos) CHECK(jumps == 0);
  }
}

TEST_CASE("baked values are the field's own, over the box of what is inside and its padding") {
  const compiler::Module module = module_of(scene_of(function("return 3.0 * (length(p - vec3(0.2, 0, 0)) - 0.5);")));
  const voml::Grid grid = bake(field_of(module), {.resolution = 40, .padding = 0.1});
  double worst = 0.0;
  for_each_sample(grid, [&](const dvec3& p, double value) {
    worst = std::max(worst, std::abs(value - 3.0 * (glm::length(p - dvec3(0.2, 0, 0)) - 0.5)));
  });
  CHECK(worst < 2.5e-7);  // half a unit in the last place of a float below 4
  // The ball, -0.3 .. 0.7 along x, and a tenth of its width; the box is proved in steps of 1/32 of the cube.
  CHECK(grid.box_lo.x == doctest::Approx(-0.4).epsilon(0.1));
  CHECK(grid.box_hi.x == doctest::Approx(0.8).epsilon(0.1));
  CHECK(grid.box_lo.x <= -0.4);
  CHECK(grid.box_hi.x >= 0.8);
  CHECK(grid.size.x == 40);
}

TEST_CASE("distances: of a field that is none, with its sign, to a share of a voxel") {
  // x^2 - r^2 of a ball; a torus as a polynomial; a ball that only says inside or outside.
  struct Shape {
    const char* body;
    double (*exact)(const dvec3&);
    double curvature;  // the greatest
    double allowed;    // in voxels, beside what the triangles' sag makes
  };
  const Shape shapes[] = {
      {"return dot(p, p) - 0.25;", [](const dvec3& p) { return glm::length(p) - 0.5; }, 2.0, 0.0},
      {"float k = dot(p, p) + 0.36 - 0.04; return k * k - 4.0 * 0.36 * dot(p.xy, p.xy);",
       [](const dvec3& p) { return 0.6 * torus_distance(p / 0.6, 1.0 / 3.0); }, 5.0, 0.0},
      {"return length(p) < 0.5 ? -1.0 : 1.0;", [](const dvec3& p) { return glm::length(p) - 0.5; }, 2.0, 0.15}};
  for (const Shape& shape : shapes) {
    CAPTURE(shape.body);
    const compiler::Module module = module_of(scene_of(function(shape.body)));
    const voml::Grid grid = bake(field_of(module), {.resolution = 64, .distance = true});
    double worst = 0.0;
    std::size_t wrong = 0;
    for_each_sample(grid, [&](const dvec3& p, double value) {
      const double exact = shape.exact(p);
      worst = std::max(worst, std::abs(value - exact));
      wrong += std::abs(exact) > 1e-6 && (value <= 0.0) != (exact < 0.0) ? 1 : 0;
    });
    MESSAGE("farthest from the exact distance: ", worst / voxel_of(grid), " voxel");
    CHECK(worst < (shape.allowed + 0.5 * shape.curvature * voxel_of(grid)) * voxel_of(grid));
    CHECK(wrong == 0);
  }
}

TEST_CASE("distances far from the boundary are those of the nearest triangle, or nearly") {
  // Sixteen balls of different sizes: every sample has several boundaries around it.
  std::string body = "float d = 9.0;";
  std::vector<std::pair<dvec3, double>> balls;
  Random random;
  for (int i = 0; i < 16; ++i) {
    const dvec3 c = glm::round(random.point(0.7) * 64.0) / 64.0;
    const double r = std::round(random.number(4, 12)) / 64.0;
    balls.emplace_back(c, r);
    body += "d = min(d, length(p - vec3(" + std::to_string(c.x) + "," + std::to_string(c.y) + "," +
            std::to_string(c.z) + ")) - " + std::to_string(r) + ");";
  }
  const compiler::Module module = module_of(scene_of(function(body + "return d * d * d;")));  // no slope at zero
  const voml::Grid grid = bake(field_of(module), {.resolution = 80, .distance = true});
  double worst = 0.0;
  for_each_sample(grid, [&](const dvec3& p, double value) {
    double exact = 9.0;
    for (const auto& [c, r] : balls) exact = std::min(exact, glm::distance(p, c) - r);
    // Inside, walls of other balls are none; where balls meet, triangles cut across the crease.
    if (exact > 3.0 * voxel_of(grid)) worst = std::max(worst, std::abs(value - exact));
  });
  MESSAGE("farthest from the exact distance: ", worst / voxel_of(grid), " voxel");
  CHECK(worst < 0.5 * 16.0 * voxel_of(grid) * voxel_of(grid));  // the sag of the smallest ball's triangles
}

TEST_CASE("the moment counts, and any number of threads gives the same bytes") {
  const compiler::Module module =
      module_of(scene_of(function("return length(p - vec3(0.001 * t - 0.5, 0, 0)) - 0.3;")));
  for (const bool distance : {false, true}) {
    const voml::Grid grid = bake(field_of(module, 700.0), {.resolution = 32, .distance = distance, .threads = 1});
    double worst = 0.0;
    for_each_sample(grid, [&](const dvec3& p, double value) {
      worst = std::max(worst, std::abs(value - (glm::length(p - dvec3(0.2, 0, 0)) - 0.3)));
    });
    CHECK(worst < (distance ? 0.05 * voxel_of(grid) : 1e-6));
    CHECK(bake(field_of(module, 700.0), {.resolution = 32, .distance = distance, .threads = 3}).values == grid.values);
  }
}

TEST_CASE("what is no finite number is counted, and written as a number beyond the cube") {
  const compiler::Module module = module_of(scene_of(function(
      "return p.x > 0.0 ? log(-p.x * p.x) : p.y > 0.0 ? 1.0 / (p.x - p.x) : p.z > 0.0 ? -1.0 / (p.x - p.x) : p.x;")));
  BakeReport report;
  const voml::Grid grid = bake(field_of(module), {.resolution = 16, .padding = 1.0}, &report);
  REQUIRE(grid.size == glm::uvec3(16));
  CHECK(report.not_finite == 16 * 16 * 16 * 7 / 8);
  for_each_sample(grid, [&](const dvec3& p, double value) {
    const double expected = p.x > 0 || p.y > 0 ? 4.0 : p.z > 0 ? -4.0 : p.x;
    REQUIRE(value == doctest::Approx(expected));
  });
}

TEST_CASE("what cannot be baked is refused") {
  const auto refused = [](const std::string& body, const BakeOptions& options, std::string_view word) {
    const compiler::Module module = module_of(scene_of(function(body)));
    BakeReport report;
    const auto grid = authoring::bake(field_of(module), options, report);
    REQUIRE_FALSE(grid.has_value());
    CAPTURE(grid.error().message);
    CHECK(grid.error().fault == Fault::input);
    CHECK(grid.error().message.find(word) != std::string::npos);
  };
  refused("return 1.0;", {}, "nothing is inside");
  refused("return -1.0;", {.distance = true}, "no boundary");
  refused("return p.x;", {.resolution = 3}, "resolution");
  refused("return p.x;", {.resolution = 513}, "resolution");
  refused("return p.x;", {.padding = -0.1}, "padding");
  refused("return p.x;", {.padding = NAN}, "padding");
}

TEST_CASE("an SDF is found by its name: the root's own first, then the only one, else --root is asked for") {
  const auto embedding = [](const std::string& what) {
    return "<OBJECT name=\"TOP\"><REGION name=\"R\" type=\"color\" rgb=\"0 0 1\">" + what + "</REGION></OBJECT>";
  };
  const std::string one = object_of(function("return p.x;"), "ONE"), two = object_of(function("return p.y;"), "TWO");
  const std::string both = "<EMBEDDED name=\"ONE\"/><EMBEDDED name=\"TWO\"/>";
  const compiler::Module only = module_of("<MVV>" + one + two + embedding("<EMBEDDED name=\"TWO\"/>") + "</MVV>");
  CHECK(field_of(only)(dvec3(0.25, 0.5, 0)) == 0.5);
  const compiler::Module root = module_of("<MVV>" + one + two + embedding(both) + "</MVV>", {}, "ONE");
  CHECK(field_of(root)(dvec3(0.25, 0.5, 0)) == 0.25);

  const compiler::Module several = module_of("<MVV>" + one + two + embedding(both) + "</MVV>");
  const auto ambiguous = authoring::find_sdf(several, "F");
  REQUIRE_FALSE(ambiguous.has_value());
  CHECK(ambiguous.error().reasons.at(0) == "choose one with --root: ONE, TWO");
  const auto unknown = authoring::find_sdf(several, "G");
  REQUIRE_FALSE(unknown.has_value());
  CHECK(unknown.error().message == "no object that the root reaches decides by an SDF 'G'");
}

}  // namespace dmvv::tests
