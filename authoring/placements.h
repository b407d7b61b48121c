// Things placed in space: positions, rotations and scales, and the seed files and the scene made of them.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "authoring/molecule.h"

namespace dmvv::authoring {

/// world = position + rotation * (scale * local), in units of the source. The rotation is proper and orthogonal.
struct Placement {
  glm::dvec3 position{0.0};
  glm::dmat3 rotation{1.0};
  glm::dvec3 scale{1.0};
};

/// How far a rotation may be from an orthogonal one: the largest entry of |R^T R - I|, or ||q|^2 - 1|. Beyond
/// `exact_rotation` it counts as repaired, beyond `hopeless_rotation` it is none.
inline constexpr double exact_rotation = 1e-6;
inline constexpr double hopeless_rotation = 0.1;

struct Rotation {
  glm::dmat3 matrix;
  double fault;  ///< how far the input was from orthogonal
};

/// The rotation nearest to a matrix in the Frobenius norm; none if the matrix is hopeless or mirrors.
/// Source: Higham 1986, "Computing the polar decomposition - with applications".
std::optional<Rotation> nearest_rotation(const glm::dmat3& matrix);

/// The rotation of a quaternion of about unit length; none if it is hopeless.
std::optional<Rotation> quaternion_rotation(double w, double x, double y, double z);

/// Rz * Ry * Rx, the order of spec/voml.md, and the angles of a rotation in it: y within -90..90 degrees.
glm::dmat3 euler_rotation(const glm::dvec3& angles_deg);
glm::dvec3 euler_angles_deg(const glm::dmat3& rotation);

/// The frame in which the boxes round all cubes fill the standard cube up to a margin of 5 % along the longest side.
/// In: at least one placement.
MoleculeFrame fit_placements(std::span<const Placement> placements);

/// What stands in the files of one kind (spec/voml.md, Seeds), in the order of the placements.
struct PlacementFiles {
  std::string seeds;
  std::string rotates;
  std::string scales;
};
PlacementFiles placement_files(std::span<const Placement> placements, const MoleculeFrame& frame);

/// The atoms of a part of an assembly in a frame of their own, and where that frame's cube stands.
struct PlacedUnit {
  std::vector<Atom> atoms;
  MoleculeFrame frame;
  std::vector<Placement> placements;  ///< in angstrom, one an operator
};

/// An assembly as objects to embed; parts without atoms to draw are left out. The frame holds all balls of all copies.
/// Cost: atoms times operators.
struct PlacedAssembly {
  std::vector<PlacedUnit> units;
  MoleculeFrame frame;
};
PlacedAssembly place_assembly(const Molecule& molecule, const Assembly& assembly);

/// A name of letters, digits, '_', '-' and '.' for files and objects; "kind" if nothing else remains.
std::string file_name_of(std::string_view name);
/// The names of files of some kinds, told apart in any case by a number behind them.
std::vector<std::string> file_names_of(std::span<const std::string> names);

/// "r g b" of kind i of a scene. Hues are a golden section of the circle apart.
std::string kind_rgb(std::size_t i);

/// Text within a comment, where two hyphens must not follow each other, and within an attribute.
std::string for_comment(std::string_view text);
std::string for_attribute(std::string_view text);

/// An object of a scene and how often it stands there. Its files begin with `stem`_`name`.
struct PlacedObject {
  std::string name;
  std::size_t count;
  std::string object;  ///< the OBJECT element
};

/// A scene in which each object stands once a line of its seed, rotate and scale file, found by an INDEX.
std::string placed_scene(std::span<const PlacedObject> objects, const std::string& stem, std::string_view comment);

/// An OBJECT of one colour: a rounded box of unequal sides, which shows how it is turned, or a ball.
std::string simple_object(const std::string& name, const std::string& rgb, bool box);

}  // namespace dmvv::authoring
