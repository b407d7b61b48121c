// Where the parts of the skin are: the seeds of its embedded objects, in units of SKIN unless said otherwise.
#pragma once

#include <vector>

#include "examples/assets.h"

namespace skin {

using assets::Placement;

/// Hairs lean; a frame's y lies along the hair.
std::vector<Placement> hairs();
/// The muscles that raise hairs.
std::vector<Placement> pili_muscles();
/// Two beside each hair, their ducts towards it.
std::vector<Placement> sebaceous_glands();
/// Coils in the depth, straight ducts above them, spirals through the epidermis to the pores.
struct SweatGlands {
  std::vector<Placement> coils, ducts, spirals;
};
SweatGlands sweat_glands();
/// Pieces of VESSEL, each 2 units of its own long, end to end: an artery, a vein, branches upwards.
std::vector<Placement> vessels();
/// Pieces of CAPILLARY below the papillae.
std::vector<Placement> capillaries();
/// Loops in the papillae, but where a hair or a duct passes.
std::vector<Placement> capillary_loops();
std::vector<Placement> pacinian_corpuscles();

/// Cells of the epidermis: columns on the junction, polyhedra above them, flat ones, scales.
std::vector<Placement> basal_cells();
std::vector<Placement> spinous_cells();
std::vector<Placement> granular_cells();
std::vector<Placement> corneocytes();

/// Collagen: thin and in all directions near the epidermis, thick and mostly level below.
std::vector<Placement> papillary_bundles();
std::vector<Placement> reticular_bundles();
std::vector<Placement> fibroblasts();
std::vector<Placement> immune_cells();
std::vector<Placement> fat_cells();
/// Collagen between the lobules of fat.
std::vector<Placement> septa_bundles();

/// Cells within a follicle's outer sheath and bulb, in the frame of HAIR; within a sebaceous gland, in its frame.
std::vector<Placement> follicle_cells();
std::vector<Placement> sebocytes();

}  // namespace skin
