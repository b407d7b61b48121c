// Makes the assets of the orange: distance grids, bitmaps, seed files, support mesh.
//
//   make_orange FOLDER      writes sdf/*.lxn  bmp/*.png  seeds/*.txt  orange.ply  into FOLDER
//
// shapes.h says what things look like, parts.h where they are, support_mesh.h what is drawn; this file writes it all.
//
// All shapes are modelled in units of ORANGE, also those of embedded objects; a grid stores them in the standard cube
// of its object. So the values of a grid are distances in orange units, whatever the object's scale, and `offset` in
// orange.voml means a thickness in orange units.
//
// Deterministic: integer random numbers, no threads, nothing depends on time or place.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <vector>

#include "examples/assets.h"
#include "examples/noise.h"
#include "parts.h"
#include "shapes.h"
#include "support_mesh.h"

namespace {

using namespace orange;
using namespace assets;

// ---- bitmaps --------------------------------------------------------------------------------------------------------

dvec3 flavedo_color(dvec3 u) {
  const double blotches = fractal_noise(u * 4.0, 41, 4, 4);
  const double grain = noise(u * 32.0, 45, 32);
  const dvec3 rgb =
      glm::mix(dvec3(0.915, 0.430, 0.035), dvec3(0.970, 0.560, 0.090), glm::clamp(0.5 + 0.6 * blotches, 0.0, 1.0));
  return rgb + 0.020 * grain;
}

dvec3 albedo_color(dvec3 u) {
  const double clouds = fractal_noise(u * 4.0, 51, 3, 4);
  const double fibres = 1.0 - std::abs(noise(u * 16.0, 55, 16));
  return glm::mix(dvec3(0.985, 0.955, 0.860), dvec3(0.950, 0.885, 0.730),
                  glm::clamp(0.4 + 0.5 * clouds + 0.35 * (fibres - 0.6), 0.0, 1.0));
}

dvec3 pulp_color(dvec3 u) {
  const double clouds = fractal_noise(u * 4.0, 61, 3, 4);
  return glm::mix(dvec3(0.985, 0.690, 0.270), dvec3(0.960, 0.590, 0.150), glm::clamp(0.5 + 0.7 * clouds, 0.0, 1.0));
}

/// Covers the cube of a vesicle once: darker along the axis, veined lengthwise, paler to the thin end.
dvec3 juice_color(dvec3 u) {
  const dvec3 p = u * 2.0 - 1.0;
  const double depth = 1.0 - std::sqrt(std::min(1.0, p.x * p.x + p.z * p.z));
  const double veins = fractal_noise(dvec3(u.x * 6.0, u.y * 3.0, u.z * 6.0) * 1.0, 71, 2, 3);
  const double tone = glm::clamp(0.15 + 0.75 * depth + 0.30 * veins, 0.0, 1.0);
  return glm::mix(dvec3(1.000, 0.735, 0.260), dvec3(0.950, 0.510, 0.050), tone);
}

void make_orange(Output& output) {
  write_grid(output, "peel.lxn", {96, 96, 96}, dvec3(1.0), skin_distance);
  write_grid(output, "section.lxn", {64, 96, 64}, section_extent, section_distance);
  write_grid(output, "vesicle.lxn", {32, 80, 32}, vesicle_extent, vesicle_distance);
  write_grid(output, "pip.lxn", {24, 40, 24}, pip_extent, pip_distance);
  write_grid(output, "core.lxn", {40, 64, 40}, core_extent, core_distance);
  write_grid(output, "hollow.lxn", {32, 48, 32}, hollow_extent, hollow_distance);
  write_grid(output, "gland.lxn", {20, 20, 20}, gland_extent, gland_distance);
  write_grid(output, "dimple.lxn", {20, 20, 20}, gland_extent, dimple_distance);
  write_grid(output, "calyx.lxn", {48, 24, 48}, calyx_extent, calyx_distance);
  write_grid(output, "ball.lxn", {16, 16, 16}, dvec3(1.0), [](dvec3 p) { return glm::length(p) - 0.85; });

  write_bitmap(output, "flavedo.png", 64, flavedo_color);
  write_bitmap(output, "albedo.png", 32, albedo_color);
  write_bitmap(output, "pulp.png", 32, pulp_color);
  write_bitmap(output, "juice.png", 32, juice_color);

  const std::vector<Gland> glands = place_glands(4000);
  write_seeds(output, "glands", "oil glands and the dimples above them", gland_placements(glands));
  write_seeds(output, "vesicles", "vesicles of a segment", vesicle_placements(900));
  write_seeds(output, "chromoplasts", "chromoplasts of a vesicle", chromoplast_placements(150));
  write_seeds(output, "pips", "pips", pip_placements());
  output.write("orange.ply", support_mesh(glands));
}

}  // namespace

int main(int argc, char** argv) { return assets::run_maker(argc, argv, "make_orange", make_orange); }
