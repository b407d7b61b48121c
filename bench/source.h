// Where a scene of the benchmark comes from: files on disk, or texts made here.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/files.h"
#include "runtime/view/view.h"

namespace dmvv::bench {

/// A scene and how to look at it.
struct SceneSource {
  std::string name;
  std::string path;  ///< of the VOML file, for `files`
  ReadFile files;
  std::string root;       ///< empty: the scene's last object
  std::string mesh_path;  ///< support mesh; empty: the standard cube
  std::vector<runtime::Plane> cuts;
  std::optional<runtime::Camera> camera;  ///< none: one that frames the mesh
  double zoom = 1.0;                      ///< divides the camera's angle of view
  std::optional<runtime::Plane> slice;    ///< a section instead of a perspective picture
  double time_ms = 0.0;
};

}  // namespace dmvv::bench
