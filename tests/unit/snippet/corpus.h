// The snippets of tests/snippets, compiled.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "compiler/snippet/snippet.h"

namespace dmvv::tests {

using compiler::snippet::Snippet;

struct Entry {
  std::string name;
  Snippet snippet;
};

inline voml::GlslText text_of(std::string text) { return {std::move(text), {{0, {}}}}; }

/// A file is the body of a snippet; what stands before a line `// ---- body` are helper functions.
inline Snippet read_entry(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string text(std::istreambuf_iterator<char>(file), {});
  voml::Function function;
  constexpr std::string_view mark = "// ---- body\n";
  if (const std::size_t at = text.find(mark); at != std::string::npos) {
    function.helpers.push_back(text_of(text.substr(0, at)));
    text.erase(0, at + mark.size());
  }
  function.body = text_of(std::move(text));
  Diagnostics diagnostics;
  auto compiled = compiler::snippet::compile_snippet(function, diagnostics);
  REQUIRE_MESSAGE(compiled, path.string() << ":\n" << diagnostics.render());
  CHECK_MESSAGE(diagnostics.render() == "", path.string());
  return *compiled;
}

inline const std::vector<Entry>& corpus() {
  static const std::vector<Entry> entries = [] {
    std::vector<std::filesystem::path> paths;
    for (const auto& file : std::filesystem::directory_iterator(DMVV_SOURCE_DIR "/tests/snippets")) {
      if (file.path().extension() == ".glsl") paths.push_back(file.path());
    }
    std::ranges::sort(paths);
    std::vector<Entry> made;
    for (const auto& path : paths) made.push_back({path.stem().string(), read_entry(path)});
    return made;
  }();
  return entries;
}

}  // namespace dmvv::tests
