// Why a point is what it is: every test that the reference made on its way, in order, and how near each was.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/grids/storage.h"
#include "compiler/reference/reference.h"

namespace dmvv::compiler {

/// The cell of a lookup grid that was asked; without one, the list is asked from its first entry on.
struct AskedCell {
  glm::uvec3 cell;
  glm::uvec3 size;
  std::uint32_t entries;  ///< in that cell
};

/// One placement of an SDF.
struct AskedPlacement {
  std::uint32_t placement = 0;  ///< seed in file order; 0 where there is one
  glm::dvec3 local{0.0};        ///< in the frame of the source, wrapped if tiled
  bool held = false;            ///< the cube, or the grid's box, holds it
  std::optional<double> value;  ///< of the source there; not computed far outside
  bool negative = false;
  bool certain = true;
  double distance = 0.0;  ///< to where this changes, in units of the root, to first order
};

struct AskedDecision {
  Id<Sdf> sdf;
  std::optional<AskedCell> cell;
  std::vector<AskedPlacement> placements;  ///< the search ends where the answer is certain
  bool negative = false;
  bool certain = true;
  double distance = 0.0;
};

struct AskedCandidate;

struct AskedGroup {
  std::optional<glm::dvec3> in_box;  ///< the point in the frame of the INDEX, if there is one
  bool held = true;                  ///< the box holds it; else nobody is asked
  bool certain = true;
  double distance = 0.0;  ///< to the border of the box
  std::optional<AskedCell> cell;
  std::vector<AskedCandidate> candidates;
};

/// One object at one point: down its tree to a region, then the region's candidates, then the region itself.
struct Visit {
  Id<Object> object;
  glm::dvec3 p{0.0};  ///< in the frame of the object
  std::vector<AskedDecision> decisions;
  Id<Region> region;
  std::vector<AskedGroup> groups;  ///< those asked
  bool answers = false;            ///< a candidate or the region itself is the answer; false: empty here
};

struct AskedCandidate {
  std::uint32_t number = 0;  ///< within the region, as paths print it
  Id<Object> object;
  glm::dvec3 local{0.0};  ///< wrapped if tiled
  bool held = false;      ///< its cube holds the point
  bool certain = true;
  double distance = 0.0;     ///< to the border of its cube
  std::vector<Visit> visit;  ///< one if held, else none
};

/// The test that came nearest to another outcome.
struct NearestTest {
  std::string what;  ///< "SDF SKIN of ORANGE", "the cube of PIP [3]"
  double distance;   ///< in units of the root, to first order
};

struct Explanation {
  ReferenceAnswer answer;
  std::vector<Visit> visit;  ///< of the root; none where its cube does not hold the point
  NearestTest nearest;
};

/// Evaluates a point and tells how. `reference` reads `module`, with this filter and unreduced texels.
///
/// Distances: of a box, to its next face; of a value, its difference from the iso value divided by its gradient, so 0
/// on the boundary, and infinite where the value does not change.
/// Cost: that of evaluating, and 1 or 6 more evaluations of each source asked.
Explanation explain(const Module& module, const Reference& reference, Filter filter, const glm::dvec3& p,
                    double time_ms);

}  // namespace dmvv::compiler
