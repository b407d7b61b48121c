// The shapes of the skin and its parts: heights of its layers, and distances, negative inside, in units of SKIN.
//
// One unit is about 0.6 mm; SKIN is the standard cube, y points out of the skin. A part's shape lives in the frame of
// its object; its `extent` is half the edges of the object's cube, which a seed file gives as scale.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace skin {

using glm::dvec2, glm::dvec3;

/// The section of the pictures is z = section: what is placed there by hand is seen cut in halves.
constexpr double section = 0.35;

// ---- layers ---------------------------------------------------------------------------------------------------------

/// The skin's surface: flat, with a net of furrows.
double surface_height(double x, double z);
/// The dermal-epidermal junction: papillae of the dermis rise into the epidermis.
double junction_height(double x, double z);
/// Where papillae have their tips, (x, z).
const std::vector<dvec2>& papillae();
/// The z of a row of them, just behind the section.
constexpr double papilla_row = section - 0.004;
/// The normal of a height field, upwards.
dvec3 normal_of(double (*height)(double, double), double x, double z);

/// Distances to the two, to first order. Each is stored in a box of the cube, which reaches below the junction's
/// valleys.
constexpr double layer_bottom = 0.36;
constexpr double surface_top = 0.80, junction_top = 0.66;
double surface_distance(dvec3 p);
double junction_distance(dvec3 p);

// ---- parts ----------------------------------------------------------------------------------------------------------

/// A packed cell: the rounded intersection of half-spaces on all sides; 0.9 wide.
double packed_cell_distance(dvec3 p);

/// A hair's follicle along y, without the hair: a bulb at its lower end; open above. Its outside; layers are offsets.
const dvec3 hair_extent(0.13, 0.80, 0.13);
double follicle_distance(dvec3 p);
/// The dermal papilla in the bulb.
double dermal_papilla_distance(dvec3 p);

/// A sebaceous gland: lobes around a duct that leaves along +y.
const dvec3 sebaceous_extent(0.115, 0.15, 0.115);
double sebaceous_distance(dvec3 p);

/// The coil of a sweat gland: one tube, wound up; its upper end leaves at (0, extent.y, 0).
const dvec3 coil_extent(0.17);
double coil_distance(dvec3 p);

}  // namespace skin
