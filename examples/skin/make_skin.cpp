// Makes the assets of the skin: distance grids, bitmaps, seed files, support mesh.
//
//   make_skin FOLDER      writes sdf/*.lxn  bmp/*.png  seeds/*.txt  skin.ply  into FOLDER
//
// shapes.h says what things look like, parts.h where they are, support_mesh.h what is drawn; this file writes it all.
// The values of a grid are distances in units of SKIN, but for those of packed_cell.lxn, which are in the cell's own.
//
// Deterministic: integer random numbers, no threads, nothing depends on time or place.
#include <glm/common.hpp>

#include "examples/assets.h"
#include "examples/noise.h"
#include "parts.h"
#include "shapes.h"
#include "support_mesh.h"

namespace {

using namespace skin;
using namespace assets;

/// A grid over the box whose middle is (0, y, 0).
void write_grid_at(Output& output, const std::string& name, glm::uvec3 size, double y, dvec3 extent,
                   double (*shape)(dvec3)) {
  write_grid(output, name, size, extent, [&](dvec3 p) { return shape(p + dvec3(0.0, y, 0.0)); });
}

dvec3 papillary_color(dvec3 u) {
  const double clouds = fractal_noise(u * 4.0, 41, 3, 4);
  const double fibres = 1.0 - std::abs(noise(u * 16.0, 45, 16));
  return glm::mix(dvec3(0.985, 0.850, 0.790), dvec3(0.930, 0.700, 0.660),
                  glm::clamp(0.25 + 0.4 * clouds + 0.5 * (fibres - 0.5), 0.0, 1.0));
}

dvec3 reticular_color(dvec3 u) {
  const double clouds = fractal_noise(u * 4.0, 51, 3, 4);
  const double fibres = 1.0 - std::abs(noise(dvec3(u.x * 4.0, u.y * 16.0, u.z * 4.0), 55, 16));
  return glm::mix(dvec3(0.975, 0.850, 0.800), dvec3(0.900, 0.680, 0.640),
                  glm::clamp(0.2 + 0.4 * clouds + 0.5 * (fibres - 0.5), 0.0, 1.0));
}

dvec3 lipid_color(dvec3 u) {
  const double clouds = fractal_noise(u * 3.0, 61, 3, 3);
  return glm::mix(dvec3(1.000, 0.905, 0.560), dvec3(0.980, 0.810, 0.390), glm::clamp(0.5 + 0.6 * clouds, 0.0, 1.0));
}

void make_skin(Output& output) {
  const double surface_middle = 0.5 * (layer_bottom + surface_top),
               junction_middle = 0.5 * (layer_bottom + junction_top);
  write_grid_at(output, "surface.lxn", {160, 48, 160}, surface_middle, {1.0, surface_top - surface_middle, 1.0},
                surface_distance);
  write_grid_at(output, "junction.lxn", {160, 40, 160}, junction_middle, {1.0, junction_top - junction_middle, 1.0},
                junction_distance);
  write_grid(output, "packed_cell.lxn", {28, 28, 28}, dvec3(1.0), packed_cell_distance);
  write_grid(output, "follicle.lxn", {36, 112, 36}, hair_extent, follicle_distance);
  write_grid_at(output, "dermal_papilla.lxn", {28, 56, 28}, -0.66, {0.065, 0.14, 0.065}, dermal_papilla_distance);
  write_grid(output, "sebaceous.lxn", {44, 56, 44}, sebaceous_extent, sebaceous_distance);
  write_grid(output, "coil.lxn", {64, 64, 64}, coil_extent, coil_distance);

  write_bitmap(output, "papillary.png", 32, papillary_color);
  write_bitmap(output, "reticular.png", 32, reticular_color);
  write_bitmap(output, "lipid.png", 32, lipid_color);

  // One basal cell in nine is a melanocyte.
  std::vector<Placement> basal, melanocytes;
  for (const Placement& cell : basal_cells())
    ((basal.size() + melanocytes.size()) % 9 == 4 ? melanocytes : basal).push_back(cell);
  write_seeds(output, "basal", "basal cells of the epidermis", basal);
  write_seeds(output, "melanocytes", "melanocytes among the basal cells", melanocytes);
  write_seeds(output, "spinous", "spinous cells", spinous_cells());
  write_seeds(output, "granular", "granular cells", granular_cells());
  write_seeds(output, "corneocytes", "corneocytes", corneocytes());

  write_seeds(output, "papillary_bundles", "thin collagen of the papillary dermis", papillary_bundles());
  write_seeds(output, "reticular_bundles", "thick collagen of the reticular dermis", reticular_bundles());
  write_seeds(output, "fibroblasts", "fibroblasts", fibroblasts());
  write_seeds(output, "immune_cells", "cells that wander", immune_cells());
  write_seeds(output, "fat_cells", "fat cells", fat_cells());
  write_seeds(output, "septa_bundles", "collagen between lobules of fat", septa_bundles());

  const SweatGlands sweat = sweat_glands();
  write_seeds(output, "hairs", "hairs", hairs());
  write_seeds(output, "pili_muscles", "muscles that raise hairs", pili_muscles());
  write_seeds(output, "sebaceous", "sebaceous glands", sebaceous_glands());
  write_seeds(output, "coils", "coils of sweat glands", sweat.coils);
  write_seeds(output, "ducts", "ducts of sweat glands", sweat.ducts);
  write_seeds(output, "spirals", "ducts in the epidermis", sweat.spirals);
  write_seeds(output, "vessels", "pieces of vessels", vessels());
  write_seeds(output, "capillaries", "pieces of capillaries", capillaries());
  write_seeds(output, "loops", "capillary loops", capillary_loops());
  write_seeds(output, "pacinian", "Pacinian corpuscles", pacinian_corpuscles());
  write_seeds(output, "follicle_cells", "cells of a follicle, in the frame of HAIR", follicle_cells());
  write_seeds(output, "sebocytes", "cells of a sebaceous gland, in its frame", sebocytes());
  output.write("skin.ply", support_mesh());
}

}  // namespace

int main(int argc, char** argv) { return assets::run_maker(argc, argv, "make_skin", make_skin); }
