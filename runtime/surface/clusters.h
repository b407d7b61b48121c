// Inside the runtime only: groups of triangles that are drawn or left out as one. Pure values.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "runtime/surface/surface.h"
#include "runtime/view/frame_setup.h"

namespace dmvv::runtime {

/// A piece of the picture that is rendered at once.
struct Tile {
  glm::uvec2 corner_px{0};
  glm::uvec2 size_px{0};
  friend bool operator==(const Tile&, const Tile&) = default;
};

struct IndexRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  friend bool operator==(const IndexRange&, const IndexRange&) = default;
};

inline constexpr std::uint32_t triangles_of_cluster = DMVV_RUN_TRIANGLES;

/// Triangles that lie together: all in a ball, their normals in a cone.
struct Cluster {
  IndexRange indices;  ///< of triangles_of_cluster triangles at most
  bool has_seen_backs =
      true;  ///< an eye outside of the mesh may see the backs of its triangles; else they are not drawn
  glm::dvec3 center{0.0};
  double radius = 0.0;
  glm::dvec3 axis{0.0};  ///< unit; of the cone
  double sine = 1.0;     ///< of the cone's half angle; 1 where it holds half a sphere or more
};

/// Puts the triangles in the order of a space-filling curve (Morton 1966), those whose backs cannot be seen first, the
/// vertices in that of their first use, and cuts the triangles into clusters. Triangles keep their corners' order.
/// `outward` says of each triangle that its back cannot be seen. Cost: linear.
std::vector<Cluster> make_clusters(Surface& surface, const std::vector<bool>& outward);

/// A mesh in the order in which it is drawn.
struct ArrangedMesh {
  Surface surface;
  std::vector<Cluster> clusters;
  voml::EdgeFaults edges;
};

/// Errors (input): those of `make_surface`. Cost: n log n in triangles, some 50 ms for 100,000.
Result<ArrangedMesh> arrange_mesh(const voml::Mesh& mesh);

/// What is done with a cluster's triangles.
struct DrawKind {
  bool is_seen = false;      ///< they may be seen
  bool counts = false;       ///< they are shells for the caps, whichever side they show
  bool is_cut = false;       ///< each pixel is tested; else the cuts leave all of it, and all of it counts
  bool shows_backs = false;  ///< where they are seen
};

struct DrawCall {
  DrawKind kind;
  IndexRange indices;
};

/// What has to be drawn. Left out are the clusters that no pixel of the tile shows: beside the picture, cut away and,
/// unless all backs are shown, turned away from the eye. Cost: linear in clusters times cuts.
std::vector<DrawCall> plan_draw(std::span<const Cluster> clusters, const FrameSetup& setup, const Tile& tile,
                                bool shows_all_backs);

/// All clusters, and each pixel of them tested.
std::vector<DrawCall> plan_whole(std::span<const Cluster> clusters, const FrameSetup& setup, bool shows_all_backs);

}  // namespace dmvv::runtime
