#include "parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "examples/cells.h"
#include "examples/noise.h"
#include "shapes.h"

namespace orange {

using namespace assets;

namespace {

using std::numbers::pi;

/// The angles of the ten segments of orange.voml, degrees about y.
constexpr std::array<double, 10> section_angles_deg = {43, 80, 115.5, 150.5, 189, 226, 261, 296.5, 333, 8.5};

}  // namespace

std::vector<Gland> place_glands(std::size_t count) {
  Random random(7);
  std::vector<Gland> glands;
  Cells cells(0.06);
  const auto crowded = [&](dvec3 direction, double distance) {
    bool found = false;
    cells.visit_near(direction, [&](std::uint32_t other) {
      found = found || glm::length(glands[other].direction - direction) < distance;
    });
    return found;
  };
  for (int tries = 0; tries < 200000 && glands.size() < count; ++tries) {
    const double y = random.uniform(-1.0, 1.0), turn = random.uniform(0.0, 2.0 * pi);
    const double from_axis = std::sqrt(1.0 - y * y);
    const dvec3 direction(from_axis * std::cos(turn), y, from_axis * std::sin(turn));
    const double size = random.uniform(0.8, 1.15);
    const double bare = y > 0.0 ? 0.11 : 0.05;  // the calyx; the scar at the other end
    if (from_axis < bare || crowded(direction, 0.0465 * size)) continue;
    cells.add(direction, static_cast<std::uint32_t>(glands.size()));
    glands.push_back({direction, size});
  }
  return glands;
}

std::vector<Placement> gland_placements(const std::vector<Gland>& glands) {
  std::vector<Placement> placements;
  for (const Gland& gland : glands) {
    const dvec3 outwards = skin_normal(gland.direction);
    placements.push_back({gland.direction * skin_radius(gland.direction),
                          frame_along(outwards, std::abs(outwards.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0)),
                          gland_extent * gland.size});
  }
  return placements;
}

// Dart throwing in a space that is stretched along each vesicle's own direction, which is the way to the core.
std::vector<Placement> vesicle_placements(std::size_t count) {
  Random random(2016);
  struct Vesicle {
    dvec3 centre, direction;
  };
  std::vector<Vesicle> vesicles;
  std::vector<Placement> placements;
  for (int tries = 0; tries < 150000 && placements.size() < count; ++tries) {
    const dvec3 p = random.uniform3(-1.0, 1.0) * section_extent;
    if (section_distance(p) > 0.004) continue;
    const dvec3 q = p + section_centre;
    const dvec3 towards_core = dvec3(0.0, 0.45 * q.y, 0.0) - q;
    const dvec3 tilt = random.uniform3(-0.1, 0.1);
    const dvec3 outwards = glm::normalize(tilt - glm::normalize(towards_core));
    const double room = 0.72 + 0.38 * glm::length(towards_core) / 0.8;  // smaller near the core
    const auto too_near = [&](const Vesicle& other) {
      const dvec3 offset = p - other.centre;
      const double along = glm::dot(offset, outwards);
      const double across_squared = glm::dot(offset, offset) - along * along;
      return along * along / (0.115 * 0.115) + across_squared / (0.0385 * 0.0385) < room * room;
    };
    if (std::any_of(vesicles.begin(), vesicles.end(), too_near)) continue;
    vesicles.push_back({p, outwards});

    // The section's frame is stretched unevenly: direction and widths are carried into it one by one.
    const double size = random.uniform(0.92, 1.12) * room;
    const dvec3 length_axis = outwards * (vesicle_extent.y * size * random.uniform(0.9, 1.15)) / section_extent;
    const glm::dmat3 frame = frame_along(glm::normalize(length_axis), dvec3(0, 0, 1));
    const auto width = [&](dvec3 axis) { return vesicle_extent.x * size / glm::length(axis * section_extent); };
    placements.push_back({p / section_extent, frame, {width(frame[0]), glm::length(length_axis), width(frame[2])}});
  }
  return placements;
}

std::vector<Placement> chromoplast_placements(std::size_t count) {
  Random random(5);
  std::vector<Placement> placements;
  while (placements.size() < count) {
    const dvec3 p = random.uniform3(-1.0, 1.0) * vesicle_extent;
    const double size = random.uniform(0.0010, 0.0026);
    if (vesicle_distance(p) > -0.004 - size) continue;
    placements.push_back({p / vesicle_extent, glm::dmat3(1.0), dvec3(size) / vesicle_extent});
  }
  return placements;
}

std::vector<Placement> pip_placements() {
  struct Pip {
    int section;
    double y, from_axis;
  };
  const std::array<Pip, 12> pips = {{{0, 0.02, 0.27},
                                     {0, 0.30, 0.25},
                                     {1, -0.26, 0.26},
                                     {2, -0.03, 0.25},
                                     {3, 0.22, 0.28},
                                     {4, -0.31, 0.25},
                                     {5, 0.03, 0.28},
                                     {5, -0.24, 0.26},
                                     {6, 0.28, 0.25},
                                     {7, -0.02, 0.26},
                                     {8, 0.24, 0.27},
                                     {9, -0.29, 0.26}}};
  Random random(3);
  std::vector<Placement> placements;
  for (const Pip& pip : pips) {
    const double angle = glm::radians(section_angles_deg[pip.section] + random.uniform(-3.0, 3.0));
    const dvec3 outwards(std::cos(angle), 0.0, -std::sin(angle));
    const dvec3 axis = glm::normalize(outwards + dvec3(0.0, random.uniform(0.1, 0.5) * (pip.y > 0 ? 1 : -1), 0.0));
    placements.push_back({outwards * pip.from_axis + dvec3(0.0, pip.y, 0.0),
                          frame_along(axis, glm::cross(axis, dvec3(0, 1, 0))), pip_extent * random.uniform(0.85, 1.1)});
  }
  return placements;
}

}  // namespace orange
