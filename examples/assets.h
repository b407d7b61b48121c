// What makers of examples share: the files of a scene, written below one folder.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace assets {

using glm::dvec3;

/// Writes below a folder; remembers the first failure.
class Output {
 public:
  explicit Output(std::string folder) : folder_(std::move(folder)) {}

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  void write(const std::string& name, const std::string& bytes);
  void fail(const std::string& message) {
    if (error_.empty()) error_ = message;
  }
  const std::string& error() const { return error_; }

 private:
  std::string folder_;
  std::string error_;
};

/// A place of a part in the frame of the object that holds it: T * rotation * S.
struct Placement {
  dvec3 position;
  glm::dmat3 rotation;
  dvec3 scale;
};

/// Writes sdf/NAME: `shape`, sampled over the cube of half edges `extent`.
void write_grid(Output& output, const std::string& name, glm::uvec3 size, dvec3 extent,
                const std::function<double(dvec3)>& shape);

/// Writes bmp/NAME: a 3D bitmap of n^3 texels as a picture of n x n^2 pixels; `color` gets the texel's middle in [0,
/// 1)^3.
void write_bitmap(Output& output, const std::string& name, int n, const std::function<dvec3(dvec3)>& color);

/// Writes seeds/NAME.txt, NAME_rotate.txt and NAME_scale.txt. Positions in the files are fractions of the cube's edge.
void write_seeds(Output& output, const std::string& name, const std::string& what,
                 const std::vector<Placement>& placements);

/// The program: `NAME FOLDER` makes FOLDER with sdf/, bmp/ and seeds/ and fills it. Returns the exit code.
int run_maker(int argc, char** argv, const std::string& name, const std::function<void(Output&)>& make);

struct Mesh {
  std::vector<dvec3> points;
  std::vector<glm::uvec3> triangles;  ///< counterclockwise from outside
};
/// The mesh as binary PLY.
std::string to_ply(const Mesh& mesh, const std::string& comment);

/// An orthonormal frame whose y axis is `d` (unit) and whose z axis is as near as possible to `z_hint`.
glm::dmat3 frame_along(dvec3 d, dvec3 z_hint);

}  // namespace assets
