// What the double-precision reference says of a scene, asked once and compared with many settings.
#pragma once

#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bench/run.h"
#include "compiler/reference/reference.h"
#include "voml/assets/mesh.h"

namespace dmvv::bench {

using Answers = std::vector<compiler::ReferenceAnswer>;

/// Answers are those of the scene as it is written, its grids in float32, between their samples as the filter says:
/// what a texel format or a form of code changes, is wrong.
class Truth {
 public:
  /// Reads the scene and its mesh. Errors: input, with the first diagnostics.
  static Result<std::unique_ptr<Truth>> create(const SceneSource& source);

  const SceneSource& source() const { return source_; }
  const voml::Mesh& mesh() const { return *mesh_; }
  bool has_grids() const { return !module_.grids.empty(); }
  runtime::View view(glm::uvec2 size_px) const;

  /// `count` points spread by chance over the box of the mesh.
  const std::vector<glm::dvec3>& points(std::size_t count);
  const Answers& at_points(std::size_t count, compiler::Filter filter);
  /// The answers at these positions; asked again only if they are others than the last time.
  const Answers& at_positions(const std::vector<glm::vec3>& positions, compiler::Filter filter);
  /// Straight colours of a slice, the mean of samples^2 answers a pixel.
  const std::vector<glm::dvec4>& mean_colors(const runtime::Plane& slice, glm::uvec2 size_px, std::uint32_t samples);

 private:
  Truth(SceneSource source, compiler::Module module, voml::Mesh mesh);
  Answers ask(const std::vector<glm::dvec3>& points, compiler::Filter filter);

  SceneSource source_;
  compiler::Module module_;
  std::shared_ptr<const voml::Mesh> mesh_;
  /// For a filter's meaning: trilinear, tricubic.
  struct Known {
    std::optional<compiler::Reference> reference;
    Answers at_points;
    std::vector<glm::vec3> positions;
    Answers at_positions;
  };
  Known& known(compiler::Filter filter);
  Known trilinear_, tricubic_;
  std::vector<glm::dvec3> points_;
  std::vector<glm::dvec4> mean_colors_;
};

/// Reads a scene's mesh; the standard cube if it names none.
Result<voml::Mesh> read_mesh(const SceneSource& source);

/// The first lines of what diagnostics have to say, as an error of the input.
Error input_error(const std::string& path, const Diagnostics& diagnostics);

RegionErrors compare_points(const Answers& truth, const std::vector<compiler::PointAnswer>& answers);

/// Compares the pixels that show something. `rmse` is that of the colours where the truth is certain.
struct PixelErrors {
  RegionErrors regions;
  double rmse = 0.0;
};
PixelErrors compare_pixels(const Answers& truth, const runtime::Picture& picture);

}  // namespace dmvv::bench
