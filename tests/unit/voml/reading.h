// Reads scenes written in a test.
#pragma once

#include <doctest/doctest.h>

#include <map>
#include <string>

#include "tests/unit/voml/test_files.h"
#include "voml/scene.h"

namespace dmvv::tests {

/// What reading a scene gave. `opened` counts how often each file was opened.
struct Reading {
  std::optional<voml::Scene> scene;
  std::string messages;
  std::map<std::string, int> opened;
  std::size_t errors = 0;
  std::size_t warnings = 0;
};

inline Reading read(const std::map<std::string, std::string>& files, const voml::ReadOptions& options = {},
                    const std::string& path = "scene.voml") {
  Reading reading;
  Diagnostics diagnostics;
  const ReadFile memory = memory_files(files);
  const ReadFile counting = [&](const std::string& name, std::uint64_t max_bytes) {
    ++reading.opened[name];
    return memory(name, max_bytes);
  };
  reading.scene = voml::read_scene(path, counting, options, diagnostics);
  reading.messages = diagnostics.render();
  reading.errors = diagnostics.error_count();
  reading.warnings = diagnostics.warning_count();
  CHECK(reading.scene.has_value() == !diagnostics.has_errors());
  return reading;
}

inline Reading read_text(const std::string& text, std::map<std::string, std::string> files = {},
                         const voml::ReadOptions& options = {}) {
  files["scene.voml"] = text;
  return read(files, options);
}

/// The scene of a text that has no fault.
inline voml::Scene scene_of(const std::string& text, std::map<std::string, std::string> files = {}) {
  files.try_emplace("plane.lxn", lxn());
  Reading reading = read_text(text, std::move(files));
  CHECK(reading.messages == "");
  REQUIRE(reading.scene.has_value());
  return std::move(*reading.scene);
}

}  // namespace dmvv::tests
