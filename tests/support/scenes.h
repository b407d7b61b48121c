// Scenes from text, read, lowered and compiled.
#pragma once

#include <doctest/doctest.h>

#include <map>
#include <memory>
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

/// Makes SPIR-V of all kernels, checked by spirv-val.
inline void translate(compiler::Program& program) {
  for (const auto source : {compiler::Source::points, compiler::Source::surface, compiler::Source::rays}) {
    const auto made = compiler::to_spirv(program, source);
    if (!made) {
      for (const auto& reason : made.error().reasons) MESSAGE(reason);
    }
    REQUIRE(made.has_value());
  }
}

/// Compiles and makes SPIR-V of all kernels.
inline compiler::Build built(const compiler::Module& module, const compiler::CompileOptions& options) {
  Diagnostics diagnostics;
  auto build = compiler::build(module, options, diagnostics);
  INFO(diagnostics.render());
  REQUIRE(build.has_value());
  translate(build->program);
  return std::move(*build);
}

/// The program alone.
inline compiler::Program compiled(const compiler::Module& module, const compiler::CompileOptions& options = {}) {
  return built(module, options).program;
}

/// Likewise, with the judge that is made beside a program for many frames.
struct Judged {
  compiler::Program program;
  std::shared_ptr<const compiler::Judge> judge;
};
inline Judged judged(const compiler::Module& module, const compiler::CompileOptions& options) {
  compiler::Build build = built(module, options);
  return {std::move(build.program), compiler::make_judge(std::move(build.module), std::move(build.records), options)};
}

}  // namespace dmvv::tests
