// What the runtime's tests share: a device under validation, a program by hand, meshes, and pictures by ray casting.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compiler/program.h"
#include "runtime/runtime.h"
#include "runtime/view/view.h"
#include "voml/assets/mesh.h"

namespace dmvv::tests {

/// What an error says, for assertions that fail.
std::string text_of(const Error& error);

/// The value; without one, the test run ends with the error's text.
template <class T>
T must(Result<T> result) {
  if (!result) FAIL(text_of(result.error()));
  return std::move(*result);
}

inline void must(Result<void> result) {
  if (!result) FAIL(text_of(result.error()));
}

/// The device all tests use, with the validation layer on. Without a Vulkan device the test fails.
runtime::Device& device();

/// Checks, when it goes, that the validation layer has said nothing since it came.
class QuietValidation {
 public:
  QuietValidation() : before_(device().validation_messages().size()) {}
  ~QuietValidation() {
    const auto messages = device().validation_messages();
    for (std::size_t i = before_; i < messages.size(); ++i) FAIL_CHECK(messages[i]);
  }

 private:
  std::size_t before_;
};

/// What the colours of a picture show.
enum class Show : std::uint32_t { position = 0, normal = 1, light = 2, checker = 3, unfinished = 4 };

/// The kernels of this folder. Region 1 of a picture is where x <= 0.25, region 2 the rest of the surface. `points`
/// answers 1 within `radius` of the origin.
compiler::Program program(Show show);
compiler::Program points_program(float radius);
compiler::Kernel kernel_of(const compiler::KernelSpec& spec, std::span<const std::uint32_t> spirv);

/// As views hold meshes.
std::shared_ptr<const voml::Mesh> shared(const voml::Mesh& mesh);
voml::Mesh sphere(double radius, const glm::dvec3& centre, int rings);
voml::Mesh torus(double major, double minor, int segments);
/// The triangles of both; those of b are turned over if `inverted`.
voml::Mesh join(voml::Mesh a, const voml::Mesh& b, bool inverted);

/// What the middle of a pixel (or a point near it) must show, found by casting a ray against every triangle in double.
struct Hit {
  double depth;
  std::optional<std::size_t> cap;  ///< the cut whose section is seen
};
std::optional<Hit> cast(const runtime::View& view, const voml::Mesh& mesh, double x_px, double y_px);

/// A folder for this run's files, empty at its start.
const std::filesystem::path& scratch();

}  // namespace dmvv::tests
