// Scenes from text, read, lowered and compiled.
#pragma once

#include <doctest/doctest.h>

#include <map>
#include <string>

#include "base/files.h"
#include "compiler/compile.h"
#include "compiler/ir/module.h"
#include "tests/support/grids.h"
#include "tests/support/random.h"
#include "voml/scene.h"

namespace dmvv::tests {

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

/// The module of a scene on disk; fails the test with the diagnostics if there are errors.
inline compiler::Module lowered_file(const std::string& path) {
  Diagnostics diagnostics;
  auto scene = voml::read_scene(path, disk_files(), {}, diagnostics);
  REQUIRE_MESSAGE(scene, diagnostics.render());
  auto module = compiler::lower(std::move(*scene), diagnostics);
  REQUIRE_MESSAGE(module, diagnostics.render());
  return std::move(*module);
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
