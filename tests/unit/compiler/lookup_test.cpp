#include "compiler/layout/lookup.h"
#include <doctest/doctest.h>
#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include "compiler/ir/placements.h"
#include "compiler/ir/rounding.h"
#include "tests/support/scenes.h"

using namespace dmvv;

namespace {

std::vector<compiler::PlacedBox> random_boxes(tests::Random& random, int count, double lo, double hi) {
  std::vector<compiler::PlacedBox> boxes;
  for (int i = 0; i < count; ++i) {
    const voml::Transform transform{random.point(-1.2, 1.2), random.point(-180, 180), random.point(lo, hi)};
    compiler::PlacedBox box;
    box.local_from_frame = compiler::local_from_object(transform);
    box.local_error = compiler::float_error(box.local_from_frame, glm::dvec3(1.0));
    boxes.push_back(box);
  }
  return boxes;
}

bool holds(const compiler::PlacedBox& box, const glm::dvec3& p) {
  return glm::all(glm::lessThanEqual(glm::abs(box.local_from_frame(p)), glm::dvec3(1.0)));
}

}  // namespace

TEST_CASE("refined, an author's size counts only if it has more cells than would be chosen") {
  tests::Random random(6);
  const auto boxes = random_boxes(random, 400, 0.01, 0.1);
  const auto size = [&](const glm::uvec3& wish, bool refine) {
    return compiler::build_lookup(boxes, wish, glm::dvec3(0.0), refine).size;
  };
  CHECK(size(glm::uvec3(3), false) == glm::uvec3(3));
  CHECK(size(glm::uvec3(3), true) == size(glm::uvec3(0), false));
  CHECK(size(glm::uvec3(100), true) == glm::uvec3(100));
  CHECK(size(glm::uvec3(1), true) == glm::uvec3(1));
}

TEST_CASE("every placement that holds a point is listed there, in order") {
  tests::Random random(5);
  for (const glm::uvec3 wish : {glm::uvec3(0), glm::uvec3(1), glm::uvec3(7, 3, 5), glm::uvec3(40)}) {
    const auto boxes = random_boxes(random, 400, 0.01, 0.3);
    const compiler::Lookup lookup = compiler::build_lookup(boxes, wish);
    for (int i = 0; i < 4000; ++i) {
      const glm::dvec3 p = random.point();
      const auto listed = lookup.at(p);
      CHECK(std::is_sorted(listed.begin(), listed.end()));
      for (std::uint32_t b = 0; b < boxes.size(); ++b) {
        if (holds(boxes[b], p)) CHECK(std::binary_search(listed.begin(), listed.end(), b));
      }
    }
  }
}

TEST_CASE("float32 arithmetic never loses a placement at cell borders") {
  // Points on the cell borders, computed as the shader computes them.
  tests::Random random(6);
  const auto boxes = random_boxes(random, 300, 0.02, 0.2);
  const compiler::Lookup lookup = compiler::build_lookup(boxes, glm::uvec3(16));
  const glm::vec3 lo(lookup.lo), per_unit(glm::dvec3(lookup.size) / (lookup.hi - lookup.lo));
  for (int i = 0; i < 20000; ++i) {
    glm::vec3 p(random.point());
    const int axis = i % 3;
    p[axis] = lo[axis] + float(random.bits() % 17) / per_unit[axis];
    if (glm::any(glm::greaterThan(glm::abs(p), glm::vec3(1.0f)))) continue;
    const glm::uvec3 cell(glm::clamp(glm::floor((p - lo) * per_unit), glm::vec3(0.0f), glm::vec3(15.0f)));
    const std::size_t c = (cell.z * 16 + cell.y) * 16 + cell.x;
    const auto first = lookup.lists.begin() + lookup.cells[c], last = lookup.lists.begin() + lookup.cells[c + 1];
    for (std::uint32_t b = 0; b < boxes.size(); ++b) {
      if (holds(boxes[b], glm::dvec3(p))) CHECK(std::binary_search(first, last, b));
    }
  }
}

TEST_CASE("a list of many small placements is searched through few") {
  tests::Random random(8);
  const auto boxes = random_boxes(random, 4000, 0.01, 0.02);
  const compiler::Lookup lookup = compiler::build_lookup(boxes, glm::uvec3(0));
  CHECK(lookup.longest <= 20);
  const auto cells = static_cast<double>(lookup.cells.size() - 1);
  CHECK(static_cast<double>(lookup.lists.size()) / cells < 3.0);
}

TEST_CASE("a wish beyond the budget is cut down, an empty list has one empty cell") {
  tests::Random random(9);
  const auto boxes = random_boxes(random, 10, 0.1, 0.2);
  const compiler::Lookup lookup = compiler::build_lookup(boxes, glm::uvec3(4000000000u, 3, 3));
  CHECK(lookup.cells.size() <= (1u << 21) + 1);
  const compiler::Lookup none = compiler::build_lookup({}, glm::uvec3(0));
  CHECK(none.cells.size() == 2);
  CHECK(none.at(glm::dvec3(0.3)).empty());
}

TEST_CASE("placements that all overlap get coarse cells, bounded lists and bounded work") {
  std::vector<compiler::PlacedBox> boxes(50000);
  for (auto& box : boxes) box.local_error = glm::dvec3(1e-6);
  const compiler::Lookup lookup = compiler::build_lookup(boxes, glm::uvec3(0));
  CHECK(lookup.lists.size() <= 1u << 24);
  CHECK(lookup.at(glm::dvec3(0.5)).size() == boxes.size());
}
