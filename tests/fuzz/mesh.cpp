// Triangle meshes: the format follows from the content, else it is OBJ.
#include <cmath>

#include "tests/fuzz/targets.h"
#include "voml/assets/mesh.h"

namespace dmvv::fuzz {

void run_mesh(std::string_view bytes) {
  Diagnostics diagnostics;
  const auto mesh = voml::parse_mesh("a.obj", bytes, diagnostics);
  must(mesh.has_value() == !diagnostics.has_errors(), "a mesh or an error");
  if (!mesh) return must(!diagnostics.render().empty(), "errors are told");
  must(!mesh->triangles.empty(), "a mesh has triangles");
  for (const glm::dvec3& p : mesh->positions)
    must(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite");
  for (const glm::uvec3& t : mesh->triangles) {
    for (int corner = 0; corner < 3; ++corner) must(t[corner] < mesh->positions.size(), "corners exist");
  }
  voml::find_edge_faults(*mesh).count();
}

}  // namespace dmvv::fuzz
