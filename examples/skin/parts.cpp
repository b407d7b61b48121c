#include "parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "examples/cells.h"
#include "examples/noise.h"
#include "shapes.h"

namespace skin {

using namespace assets;

namespace {

using std::numbers::pi;

const glm::dmat3 upright(1.0);

/// The frame with y along `d`, turned around it by an angle.
glm::dmat3 turned_frame(dvec3 d, double turn) {
  const dvec3 y = glm::normalize(d);
  const glm::dmat3 f = frame_along(y, std::abs(y.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0));
  return {std::cos(turn) * f[0] + std::sin(turn) * f[2], f[1], std::cos(turn) * f[2] - std::sin(turn) * f[0]};
}

dvec3 direction(Random& random) {
  for (;;) {
    const dvec3 d = random.uniform3(-1.0, 1.0);
    const double length = glm::length(d);
    if (length < 1.0 && length > 0.1) return d / length;
  }
}

glm::dmat3 any_frame(Random& random) {
  const dvec3 d = direction(random);
  return turned_frame(d, random.uniform(0.0, 2.0 * pi));
}

/// Places of a face-centred lattice whose neighbours lie `apart`, each moved by up to `jitter`, between two corners.
std::vector<dvec3> packed(dvec3 lo, dvec3 hi, double apart, double jitter, Random& random) {
  const double a = apart * std::sqrt(2.0);
  std::vector<dvec3> places;
  const glm::ivec3 n(glm::ceil((hi - lo) / (0.5 * a)));
  for (int z = 0; z <= n.z; ++z)
    for (int y = 0; y <= n.y; ++y)
      for (int x = 0; x <= n.x; ++x)
        if ((x + y + z) % 2 == 0) places.push_back(lo + 0.5 * a * dvec3(x, y, z) + random.uniform3(-jitter, jitter));
  return places;
}

/// Where the skin's surface is met by something upright: the pores of sweat glands. The first lies in the section.
constexpr std::array<std::array<double, 2>, 6> pores{
    {{0.03, section - 0.012}, {-0.62, -0.10}, {0.58, -0.15}, {-0.15, -0.62}, {0.75, -0.75}, {0.55, 0.78}}};

struct Hair {
  double x, z;          // where it leaves the skin
  double lean, toward;  // degrees from upright; about y, 0 is towards +x
  double size;
};
constexpr std::array<Hair, 6> hair_table{{{-0.33, section, 17.0, 0.0, 1.0},
                                          {0.47, -0.40, 15.0, 20.0, 0.95},
                                          {-0.50, -0.45, 19.0, -15.0, 0.92},
                                          {0.10, -0.85, 16.0, 10.0, 0.85},
                                          {0.84, 0.15, 14.0, -5.0, 0.80},
                                          {-0.80, 0.80, 16.0, 15.0, 0.90}}};

dvec3 along(const Hair& hair) {
  const double lean = glm::radians(hair.lean), toward = glm::radians(hair.toward);
  return {std::sin(lean) * std::cos(toward), std::cos(lean), std::sin(lean) * std::sin(toward)};
}
/// The local y, in units of SKIN, at which a hair leaves the skin.
constexpr double exit_y = 0.44;

dvec3 middle(const Hair& hair) {
  return dvec3(hair.x, surface_height(hair.x, hair.z), hair.z) - along(hair) * exit_y * hair.size;
}

/// Changes its sign from one lobule of fat to the next.
double lobule(dvec3 p) { return noise(dvec3(1.15, 0.9, 1.15) * p + dvec3(40.3, 7.1, 21.7), 71); }

/// Pieces of a vessel end to end along a path, `path(s)` at the distance s from its start. A piece is 2 of its units
/// long; `scale` is its radius and half its length. Where the path bends they are longer by as much as their outer
/// sides part.
template <class Path>
void chain(std::vector<Placement>& placements, double scale, int count, Path path) {
  const auto place = [&](int i) { return path(2.0 * scale * i); };
  const auto step = [&](int i) { return glm::normalize(place(i + 1) - place(i)); };
  for (int i = 0; i < count; ++i) {
    const dvec3 a = place(i), b = place(i + 1);
    const double turn = std::max(glm::length(step(i) - step(i - 1)), glm::length(step(i + 1) - step(i)));
    const double half_length = 0.5 * 1.0002 * glm::length(b - a) + (turn > 1e-6 ? 0.5 * turn * scale : 0.0);
    placements.push_back({0.5 * (a + b), turned_frame(b - a, 0.0), {scale, half_length, scale}});
  }
}

/// Scales on the skin: flat cells at a depth below the surface, as if in rows that were shaken.
void flat_cells(std::vector<Placement>& placements, double depth, double apart, dvec3 scale, Random& random) {
  const int n = static_cast<int>(2.1 / apart);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const dvec3 shake = random.uniform3(-0.25, 0.25);
      const double x = -1.05 + apart * (i + 0.5 * (j % 2) + shake.x), z = -1.05 + apart * (j + shake.z) * 0.9;
      if (std::abs(x) > 1.0 || z > 1.0) continue;
      const double turn = random.uniform(0.0, 2.0 * pi), size = random.uniform(0.85, 1.15);
      placements.push_back({dvec3(x, surface_height(x, z) - depth * (1.0 + 0.15 * shake.y), z),
                            turned_frame(normal_of(surface_height, x, z), turn), scale * dvec3(size, 1.0, size)});
    }
}

}  // namespace

std::vector<Placement> hairs() {
  std::vector<Placement> placements;
  for (const Hair& hair : hair_table)
    placements.push_back({middle(hair), turned_frame(along(hair), 0.0), hair_extent * hair.size});
  return placements;
}

std::vector<Placement> pili_muscles() {
  std::vector<Placement> placements;
  for (const Hair& hair : hair_table) {
    // On the side to which the hair leans, from below the gland up to the epidermis.
    const double toward = glm::radians(hair.toward);
    const dvec3 low =
        middle(hair) - along(hair) * (0.10 * hair.size) + dvec3(0.05 * std::cos(toward), 0.0, 0.05 * std::sin(toward));
    const dvec3 high(hair.x + 0.33 * std::cos(toward), 0.425, hair.z + 0.33 * std::sin(toward));
    placements.push_back(
        {0.5 * (low + high), turned_frame(high - low, 0.0), {0.030, 0.52 * glm::length(high - low), 0.030}});
  }
  return placements;
}

std::vector<Placement> septa_bundles() {
  Random random(14);
  std::vector<Placement> placements;
  while (placements.size() < 1200) {
    const dvec3 p(random.uniform(-1.0, 1.0), random.uniform(-1.0, -0.20), random.uniform(-1.0, 1.0)),
        d = direction(random);
    const double turn = random.uniform(0.0, 2.0 * pi), width = random.uniform(0.010, 0.020),
                 length = random.uniform(0.06, 0.12);
    if (std::abs(lobule(p)) > 0.06) continue;
    placements.push_back({p, turned_frame(d, turn), {width, length, 0.7 * width}});
  }
  return placements;
}

std::vector<Placement> sebaceous_glands() {
  std::vector<Placement> placements;
  for (const Hair& hair : hair_table) {
    const glm::dmat3 frame = turned_frame(along(hair), 0.0);
    for (int side = 0; side < 2; ++side) {
      // To the right, as seen in the section; the second behind and smaller.
      const double angle = glm::radians(hair.toward + (side == 0 ? 0.0 : -110.0));
      const dvec3 out = glm::normalize(dvec3(std::cos(angle), 0.0, std::sin(angle)));
      const double size = (side == 0 ? 1.0 : 0.8) * hair.size;
      const dvec3 duct = glm::normalize(frame[1] * 0.75 - out * 0.65);
      const dvec3 mouth = middle(hair) + frame[1] * (0.235 * hair.size) + out * (0.055 * hair.size);
      placements.push_back({mouth - duct * (0.135 * size), turned_frame(duct, 0.0), sebaceous_extent * size});
    }
  }
  return placements;
}

SweatGlands sweat_glands() {
  SweatGlands glands;
  Random random(31);
  for (const auto& [x, z] : pores) {
    const double turn = random.uniform(0.0, 2.0 * pi), y = -0.17 - random.uniform(0.0, 0.06);
    const glm::dmat3 frame = turned_frame({0, 1, 0}, glands.coils.empty() ? 0.0 : turn);
    glands.coils.push_back({{x, y, z}, frame, coil_extent});
    // A spiral is 0.30 high and ends just below the surface; the duct joins the two.
    const double top = surface_height(x, z) + 0.012, spiral = 0.15, low = y + 0.165, high = top - 2.0 * spiral + 0.004;
    glands.spirals.push_back({{x, top - spiral, z}, frame, {0.05, spiral, 0.05}});
    glands.ducts.push_back({{x, 0.5 * (low + high), z}, frame, {0.05, 0.5 * (high - low), 0.05}});
  }
  return glands;
}

std::vector<Placement> vessels() {
  std::vector<Placement> placements;
  // The artery, cut lengthwise, and a vein behind it, flowing back.
  chain(placements, 0.1, 10, [](double s) { return dvec3(s - 1.0, -0.60, section); });
  chain(placements, 0.125, 8, [](double s) { return dvec3(1.0 - s, -0.74 + 0.02 * std::sin(3.0 * s), 0.04); });
  // Branches: up from the artery, down to the vein.
  chain(placements, 0.055, 8, [](double s) { return dvec3(0.42 + 0.03 * std::sin(3.5 * s), s - 0.52, section); });
  chain(placements, 0.055, 10, [](double s) { return dvec3(-0.10, 0.36 - s, -0.28 + 0.04 * std::sin(3.0 * s)); });
  chain(placements, 0.050, 10, [](double s) { return dvec3(0.80 + 0.04 * std::sin(4.0 * s), s - 0.66, -0.35); });
  return placements;
}

std::vector<Placement> capillaries() {
  std::vector<Placement> placements;
  const double scale = 0.032;
  const auto wave = [](double s, double phase) {
    return 0.022 * std::sin(5.0 * s + phase) + 0.008 * std::sin(13.0 * s + 2.0 * phase);
  };
  for (const double z : {-0.76, -0.30, 0.10, section - 0.012, 0.72})
    chain(placements, scale, 33,
          [&](double s) { return dvec3(s - 1.02, 0.345 + wave(s, 9.0 * z), z + wave(s, 5.0 * z + 1.0)); });
  for (const double x : {-0.70, 0.24, 0.72})
    chain(placements, scale, 33,
          [&](double s) { return dvec3(x + wave(s, 7.0 * x), 0.305 + wave(s, 3.0 * x), s - 1.02); });
  return placements;
}

std::vector<Placement> capillary_loops() {
  std::vector<Placement> placements;
  Random random(41);
  for (const dvec2 site : papillae()) {
    const double turn = random.uniform(0.0, 2.0 * pi);
    if (std::abs(site.x) > 0.97 || std::abs(site.y) > 0.97) continue;
    bool taken = false;
    for (const Hair& hair : hair_table) {
      const dvec3 at = dvec3(hair.x, 0.5, hair.z) - along(hair) * 0.2;
      taken = taken || glm::length(site - dvec2(at.x, at.z)) < 0.10;
    }
    for (const auto& [x, z] : pores) taken = taken || glm::length(site - dvec2(x, z)) < 0.06;
    if (taken) continue;
    const double scale = 0.105;
    // Its upper end, at 0.93 of the scale, stays below the tip.
    const double tip = junction_height(site.x, site.y) - 0.018;
    placements.push_back({{site.x, tip - 0.93 * scale, site.y},
                          turned_frame({0, 1, 0}, site.y == papilla_row ? 0.0 : turn),
                          dvec3(scale)});
  }
  return placements;
}

std::vector<Placement> pacinian_corpuscles() {
  return {{{0.72, -0.30, section - 0.01}, turned_frame({0.5, 1.0, 0.0}, 0.0), {0.115, 0.165, 0.115}},
          {{0.93, -0.66, -0.02}, turned_frame({0.1, 0.6, 1.0}, 0.0), {0.10, 0.14, 0.10}},
          {{-0.55, -0.78, -0.40}, turned_frame({1.0, 0.4, 0.2}, 0.0), {0.10, 0.15, 0.10}}};
}

// Dart throwing on the junction.
std::vector<Placement> basal_cells() {
  Random random(2);
  std::vector<Placement> placements;
  std::vector<dvec3> places;
  const double apart = 0.0255;
  Cells cells(apart);
  for (int tries = 0; tries < 90000; ++tries) {
    const double x = random.uniform(-1.0, 1.0), z = random.uniform(-1.0, 1.0), turn = random.uniform(0.0, 2.0 * pi);
    const double size = random.uniform(0.9, 1.1);
    const dvec3 n = normal_of(junction_height, x, z);
    const dvec3 p = dvec3(x, junction_height(x, z), z) + 0.019 * n;
    bool crowded = false;
    cells.visit_near(p, [&](std::uint32_t other) { crowded = crowded || glm::length(places[other] - p) < apart; });
    if (crowded) continue;
    cells.add(p, static_cast<std::uint32_t>(places.size()));
    places.push_back(p);
    placements.push_back({p, turned_frame(n, turn), dvec3(0.0195, 0.0250, 0.0195) * size});
  }
  return placements;
}

std::vector<Placement> spinous_cells() {
  Random random(3);
  std::vector<Placement> placements;
  for (const dvec3 p : packed({-1.0, 0.46, -1.0}, {1.0, 0.64, 1.0}, 0.037, 0.004, random)) {
    const double turn = random.uniform(0.0, 2.0 * pi), size = random.uniform(0.95, 1.1);
    const dvec3 tilt = random.uniform3(-0.3, 0.3);
    const double above = junction_distance(p), below = -surface_distance(p);
    if (above < 0.030 || below < 0.072 || std::abs(p.x) > 1.0 || std::abs(p.z) > 1.0) continue;
    // Flatter the nearer they are to the surface.
    const double flat = glm::smoothstep(0.16, 0.08, below);
    const dvec3 up = glm::normalize(glm::mix(dvec3(0, 1, 0) + 3.0 * tilt, dvec3(0, 1, 0), flat));
    placements.push_back(
        {p, turned_frame(up, turn), size * glm::mix(dvec3(0.0235), dvec3(0.029, 0.0165, 0.029), flat)});
  }
  return placements;
}

std::vector<Placement> granular_cells() {
  Random random(4);
  std::vector<Placement> placements;
  for (const double depth : {0.049, 0.060, 0.071}) flat_cells(placements, depth, 0.052, {0.032, 0.0068, 0.032}, random);
  return placements;
}

std::vector<Placement> corneocytes() {
  Random random(5);
  std::vector<Placement> placements;
  for (int layer = 0; layer < 7; ++layer)
    flat_cells(placements, 0.003 + 0.0062 * layer, 0.080, {0.052, 0.0034, 0.052}, random);
  return placements;
}

std::vector<Placement> papillary_bundles() {
  Random random(6);
  std::vector<Placement> placements;
  while (placements.size() < 1100) {
    const double x = random.uniform(-1.0, 1.0), z = random.uniform(-1.0, 1.0), y = random.uniform(0.27, 0.56);
    const dvec3 d = direction(random);
    const double length = random.uniform(0.05, 0.09), turn = random.uniform(0.0, 2.0 * pi),
                 width = random.uniform(0.006, 0.010);
    if (junction_distance({x, y, z}) > -0.02) continue;
    // Upright in the papillae.
    const dvec3 axis = y > 0.46 ? dvec3(0.35 * d.x, 1.0, 0.35 * d.z) : dvec3(d.x, 0.5 * d.y, d.z);
    placements.push_back({{x, y, z}, turned_frame(axis, turn), {width, length, width}});
  }
  return placements;
}

std::vector<Placement> reticular_bundles() {
  Random random(7);
  std::vector<Placement> placements;
  while (placements.size() < 3600) {
    const dvec3 p(random.uniform(-1.05, 1.05), random.uniform(-0.34, 0.32), random.uniform(-1.05, 1.05));
    const double angle = random.uniform(0.0, 2.0 * pi), rise = random.uniform(-0.22, 0.22),
                 turn = random.uniform(0.0, 2.0 * pi);
    const double width = random.uniform(0.018, 0.040), length = width * random.uniform(6.0, 9.0),
                 flat = random.uniform(0.6, 0.9);
    placements.push_back(
        {p, turned_frame({std::cos(angle), rise, std::sin(angle)}, turn), {width, length, flat * width}});
  }
  return placements;
}

std::vector<Placement> fibroblasts() {
  Random random(8);
  std::vector<Placement> placements;
  while (placements.size() < 420) {
    const dvec3 p(random.uniform(-1.0, 1.0), random.uniform(-0.32, 0.45), random.uniform(-1.0, 1.0));
    const double angle = random.uniform(0.0, 2.0 * pi), rise = random.uniform(-0.3, 0.3),
                 size = random.uniform(0.8, 1.2);
    if (junction_distance(p) > -0.03) continue;
    placements.push_back(
        {p, turned_frame({std::cos(angle), rise, std::sin(angle)}, 0.0), size * dvec3(0.013, 0.046, 0.010)});
  }
  return placements;
}

std::vector<Placement> immune_cells() {
  Random random(9);
  std::vector<Placement> placements;
  while (placements.size() < 40) {
    dvec3 p(random.uniform(-0.98, 0.98), random.uniform(-0.25, 0.44), random.uniform(-0.98, 0.98));
    const double size = random.uniform(0.016, 0.022);
    if (placements.size() % 5 == 0) p.z = section - 0.004;
    if (junction_distance(p) > -0.03) continue;
    placements.push_back({p, any_frame(random), dvec3(size)});
  }
  return placements;
}

std::vector<Placement> fat_cells() {
  Random random(10);
  std::vector<Placement> placements;
  for (const dvec3 p : packed({-1.05, -1.02, -1.05}, {1.05, -0.22, 1.05}, 0.150, 0.016, random)) {
    const double size = random.uniform(0.92, 1.06);
    const glm::dmat3 frame = any_frame(random);
    // Lobules, with septa of collagen between them.
    if (std::abs(lobule(p)) < 0.03) continue;
    placements.push_back({p, frame, dvec3(0.1005 * size)});
  }
  return placements;
}

std::vector<Placement> follicle_cells() {
  Random random(12);
  std::vector<Placement> placements;
  for (const dvec3 p : packed({-0.11, -0.78, -0.11}, {0.11, 0.40, 0.11}, 0.0235, 0.003, random)) {
    const double size = random.uniform(0.95, 1.1);
    const double d = follicle_distance(p), r = std::sqrt(p.x * p.x + p.z * p.z);
    if (d > -0.016 || (p.y > -0.55 && r < 0.032)) continue;
    // The frame of HAIR is stretched; cells stay upright so that they are round in units of SKIN.
    placements.push_back({p / hair_extent, upright, dvec3(0.0148 * size) / hair_extent});
  }
  return placements;
}

std::vector<Placement> sebocytes() {
  Random random(13);
  std::vector<Placement> placements;
  for (const dvec3 p : packed({-0.11, -0.14, -0.11}, {0.11, 0.12, 0.11}, 0.030, 0.004, random)) {
    const double size = random.uniform(0.95, 1.1);
    if (sebaceous_distance(p) > -0.006) continue;
    placements.push_back({p / sebaceous_extent, upright, dvec3(0.0192 * size) / sebaceous_extent});
  }
  return placements;
}

}  // namespace skin
