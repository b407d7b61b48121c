// Clusters hold what they say, and a plan leaves out nothing that is seen.
#include "runtime/surface/clusters.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "support.h"

using namespace dmvv;
using namespace dmvv::tests;
using runtime::Cluster;
using runtime::DrawCall;
using runtime::Surface;

namespace {

using Corners = std::array<std::array<float, 3>, 3>;

Corners corners_of(const Surface& surface, std::size_t first_index) {
  Corners corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::vec3& p = surface.vertices[surface.indices[first_index + i]].position;
    corners[i] = {p.x, p.y, p.z};
  }
  return corners;
}

std::vector<Corners> sorted_triangles(const Surface& surface) {
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < surface.indices.size(); i += 3) triangles.push_back(corners_of(surface, i));
  std::ranges::sort(triangles);
  return triangles;
}

glm::dvec3 point(const std::array<float, 3>& p) { return {p[0], p[1], p[2]}; }

struct Clustered {
  Surface surface;
  std::vector<Cluster> clusters;
};

Clustered clustered(const voml::Mesh& mesh) {
  Clustered made{must(runtime::make_surface(mesh)), {}};
  made.clusters = runtime::make_clusters(made.surface, voml::outward_triangles(mesh));
  return made;
}

/// Triangles that may be seen (or are counted), by the calls of a plan.
std::size_t triangles_of(const std::vector<DrawCall>& calls, bool counts) {
  std::size_t indices = 0;
  for (const DrawCall& call : calls)
    indices += (counts ? call.kind.counts : call.kind.is_seen) ? call.indices.count : 0;
  return indices / 3;
}

runtime::View view_from(const glm::dvec3& eye, const glm::dvec3& look, std::vector<runtime::Plane> cuts = {}) {
  runtime::View view;
  view.size_px = {160, 90};
  view.camera = {.eye = eye, .look = look};
  view.cuts = std::move(cuts);
  return view;
}

std::vector<DrawCall> plan(const Clustered& of, const runtime::View& view, bool shows_all_backs = false) {
  const auto setup = must(runtime::plan_frame_setup(view, of.surface.bounds, 16384));
  return runtime::plan_draw(of.clusters, setup, {{0, 0}, setup.size_px}, shows_all_backs);
}

}  // namespace

TEST_CASE("clusters hold all triangles, in their balls and cones") {
  const voml::Mesh mesh = torus(0.65, 0.3, 160);
  const Surface before = must(runtime::make_surface(mesh));
  const auto [surface, clusters] = clustered(mesh);
  CHECK(sorted_triangles(before) == sorted_triangles(surface));
  CHECK(surface.vertices.size() == before.vertices.size());
  std::uint32_t next = 0;
  std::size_t outside = 0, turned = 0, narrow = 0;
  for (const Cluster& cluster : clusters) {
    CHECK(cluster.indices.first == next);
    CHECK_FALSE(cluster.has_seen_backs);
    next += cluster.indices.count;
    narrow += cluster.sine < 0.9;
    for (std::uint32_t i = cluster.indices.first; i < next; i += 3) {
      const Corners corners = corners_of(surface, i);
      for (const auto& corner : corners)
        outside += glm::distance(point(corner), cluster.center) > cluster.radius + 1e-9;
      const glm::dvec3 a = point(corners[0]);
      const glm::dvec3 normal = glm::normalize(glm::cross(point(corners[1]) - a, point(corners[2]) - a));
      turned += cluster.sine < 1.0 && glm::length(glm::cross(normal, cluster.axis)) > cluster.sine + 1e-6;
    }
  }
  CHECK(next == surface.indices.size());
  CHECK(outside == 0);
  CHECK(turned == 0);
  CHECK(narrow > clusters.size() / 2);
}

TEST_CASE("voids stand behind the outward triangles, and their backs are seen") {
  const voml::Mesh hollow = join(sphere(0.9, {0.0, 0.0, 0.0}, 24), sphere(0.6, {0.05, 0.0, 0.0}, 10), true);
  const auto [surface, clusters] = clustered(hollow);
  std::size_t seen = 0;
  for (const Cluster& cluster : clusters) {
    if (cluster.has_seen_backs) seen += cluster.indices.count / 3;
    CHECK((glm::distance(point(corners_of(surface, cluster.indices.first)[0]), {0.05, 0.0, 0.0}) < 0.61) ==
          cluster.has_seen_backs);
  }
  CHECK(seen == sphere(0.6, {0.05, 0.0, 0.0}, 10).triangles.size());
}

TEST_CASE("what is beside the picture, turned away or cut away is left out") {
  const auto ball = clustered(sphere(0.9, {0.0, 0.0, 0.0}, 96));
  const std::size_t all = ball.surface.indices.size() / 3;
  const glm::dvec3 eye(0.0, 0.0, 5.0);
  /// All that must be drawn is; of the rest most is not (the clusters around the poles hold triangles of many
  /// directions).
  const auto check_drawn = [&](const std::vector<DrawCall>& calls, auto must_be_drawn) {
    std::size_t expected = 0;
    for (std::size_t i = 0; i < ball.surface.indices.size(); i += 3)
      expected += must_be_drawn(corners_of(ball.surface, i));
    CHECK(triangles_of(calls, false) >= expected);
    CHECK(triangles_of(calls, false) < expected + all / 3);
  };
  CHECK(triangles_of(plan(ball, view_from(eye, {0.0, 0.0, 0.0}), true), false) == all);
  CHECK(plan(ball, view_from(eye, {0.0, 0.0, 9.0})).empty());
  CHECK(plan(ball, view_from(eye, {8.0, 0.0, 0.0})).empty());
  check_drawn(plan(ball, view_from(eye, {0.0, 0.0, 0.0})), [&](const Corners& c) {
    return glm::dot(glm::cross(point(c[1]) - point(c[0]), point(c[2]) - point(c[0])), eye - point(c[0])) > 0.0;
  });
  const auto reaches = [](double sign, double d) {
    return [=](const Corners& corners) {
      return std::ranges::any_of(corners, [&](const auto& p) { return sign * p[2] <= d; });
    };
  };
  const auto front = plan(ball, view_from(eye, {0.0, 0.0, 0.0}, {{{0.0, 0.0, 1.0}, 0.2}}), true);
  check_drawn(front, reaches(1.0, 0.2));
  CHECK(triangles_of(front, true) == triangles_of(front, false));
  std::size_t tested = 0;
  for (const DrawCall& call : front) tested += call.kind.is_cut ? call.indices.count / 3 : 0;
  CHECK(tested > 0);
  CHECK(tested < all / 3);
  const auto back = plan(ball, view_from(eye, {0.0, 0.0, 0.0}, {{{0.0, 0.0, -1.0}, 0.2}}), true);
  check_drawn(back, reaches(-1.0, 0.2));
  CHECK(triangles_of(back, true) == 0);  // the eye is left and outside: no section is seen
}
