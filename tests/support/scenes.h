// Scenes and assets that tests make from formulas, so that expected values come from mathematics.
#pragma once

#include <doctest/doctest.h>

#include <functional>
#include <map>
#include <string>

#include "compiler/compile.h"
#include "compiler/module.h"
#include "tests/support/random.h"
#include "voml/scene.h"

namespace dmvv::tests {

/// A cell-centred grid of f over a box of the standard cube.
inline voml::Grid grid_of(glm::uvec3 size, const std::function<double(glm::dvec3)>& f, glm::dvec3 lo = glm::dvec3(-1.0),
                          glm::dvec3 hi = glm::dvec3(1.0)) {
  voml::Grid grid;
  grid.size = size;
  grid.box_lo = lo;
  grid.box_hi = hi;
  for (std::uint32_t z = 0; z < size.z; ++z) {
    for (std::uint32_t y = 0; y < size.y; ++y) {
      for (std::uint32_t x = 0; x < size.x; ++x) {
        const glm::dvec3 p = lo + (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(size) * (hi - lo);
        grid.values.push_back(static_cast<float>(f(p)));
      }
    }
  }
  return grid;
}

inline std::string sphere_lxn(std::uint32_t n, double radius, glm::dvec3 center = glm::dvec3(0.0)) {
  return voml::write_lxn(grid_of(glm::uvec3(n), [=](glm::dvec3 p) { return glm::length(p - center) - radius; }));
}

/// x > 0 is positive: a plane, exact on any grid.
inline std::string plane_lxn(std::uint32_t n = 4) {
  return voml::write_lxn(grid_of(glm::uvec3(n), [](glm::dvec3 p) { return p.x; }));
}

using Files = std::map<std::string, std::string>;

/// Reads "scene.voml" with files beside it; fails the test with the diagnostics if there are errors.
inline voml::Scene read(const std::string& text, Files files = {}, const std::string& root = {}) {
  files["scene.voml"] = text;
  Diagnostics diagnostics;
  auto scene = voml::read_scene("scene.voml", memory_files(std::move(files)), {root, false}, diagnostics);
  INFO(diagnostics.render());
  REQUIRE(scene.has_value());
  return std::move(*scene);
}

inline compiler::Module lowered(const std::string& text, Files files = {}) {
  Diagnostics diagnostics;
  auto module = compiler::lower(read(text, std::move(files)), diagnostics);
  INFO(diagnostics.render());
  REQUIRE(module.has_value());
  return std::move(*module);
}

/// Compiles and makes SPIR-V of both kernels, checked by spirv-val.
inline compiler::Program compiled(const compiler::Module& module, const compiler::CompileOptions& options = {}) {
  Diagnostics diagnostics;
  auto program = compiler::compile(module, options, diagnostics);
  INFO(diagnostics.render());
  REQUIRE(program.has_value());
  for (const auto kernel : {compiler::Kernel::points, compiler::Kernel::pixels}) {
    const auto made = compiler::to_spirv(*program, kernel);
    if (!made) {
      for (const auto& reason : made.error().reasons) MESSAGE(reason);
    }
    REQUIRE(made.has_value());
  }
  return std::move(*program);
}

}  // namespace dmvv::tests
