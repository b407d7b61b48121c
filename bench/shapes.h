// Shapes whose surface is known exactly, and the scenes that show them sampled on a grid.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/displacement.h"
#include "bench/source.h"
#include "voml/assets/grid.h"

namespace dmvv::bench {

/// A shape in the standard cube, off centre so that no grid meets it symmetrically.
struct Shape {
  std::string name;
  std::function<double(const glm::dvec3&)> distance;  ///< exact, negative inside
  std::vector<SurfacePoint> surface;                  ///< spread evenly over its area
  double reach;                                       ///< half the distance to the medial axis: brackets of boundaries
};

Shape sphere(std::size_t surface_points);
Shape torus(std::size_t surface_points);

/// A cell-centred grid of n^3 samples of f over the standard cube.
voml::Grid sample_grid(std::uint32_t n, const std::function<double(const glm::dvec3&)>& f);

/// A scene of one object: the shape sampled on n^3 samples, region 1 inside, region 2 around it.
SceneSource grid_scene(const Shape& shape, std::uint32_t n);

}  // namespace dmvv::bench
