// Scenes compiled from texts, and what is said about them.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "compiler/snippet/snippet.h"
#include "voml/scene.h"

namespace dmvv::tests {

using compiler::snippet::compile_snippet;
using compiler::snippet::Snippet;

struct Outcome {
  std::vector<std::optional<Snippet>> snippets;
  std::vector<std::string> messages;  ///< "file:line:col: CODE sentence", in the order of places, notes left out
};

inline Outcome compile(const std::map<std::string, std::string>& files) {
  Diagnostics diagnostics;
  Outcome outcome;
  const auto scene = voml::read_scene("s.voml", memory_files(files), {}, diagnostics);
  CHECK_MESSAGE(scene.has_value(), diagnostics.render());
  if (!scene) return outcome;
  for (const voml::Function& function : scene->functions) {
    outcome.snippets.push_back(compile_snippet(function, diagnostics));
  }
  std::vector<Diagnostic> sorted = diagnostics.all();
  std::stable_sort(sorted.begin(), sorted.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::pair(a.span.source.index, a.span.begin) < std::pair(b.span.source.index, b.span.begin);
  });
  for (const Diagnostic& d : sorted) {
    REQUIRE(d.span.source.valid());
    const LineColumn at = diagnostics.locate(d.span.source, d.span.begin);
    outcome.messages.push_back(fmt::format("{}:{}:{}: {} {}", diagnostics.source_name(d.span.source), at.line,
                                           at.column, info(d.code).number, d.message));
  }
  return outcome;
}

/// A scene whose one function has this body, written as it stands.
inline std::string scene_of(const std::string& body, const std::string& functions = "") {
  const std::string block = functions.empty() ? "" : "<FUNCTIONS><![CDATA[" + functions + "]]></FUNCTIONS>\n";
  return "<MVV>\n" + block + "<OBJECT name='A'>\n  <SDF name='S' function='true'><![CDATA[" + body +
         "]]></SDF>\n  <REGION name='R' type='empty'/>\n</OBJECT></MVV>\n";
}

/// Takes the '@' out of a text; their places as "file:line:col: ".
inline std::vector<std::string> take_marks(const std::string& file, std::string& text) {
  std::vector<std::string> places;
  int line = 1, column = 1;
  std::string clean;
  for (const char c : text) {
    if (c == '@') {
      places.push_back(fmt::format("{}:{}:{}: ", file, line, column));
      continue;
    }
    clean += c;
    column = c == '\n' ? 1 : column + 1;
    line += c == '\n';
  }
  text = clean;
  return places;
}

/// Compiles files in which '@' stands before everything that is at fault; `expected` says code and sentence of each.
inline void check_marked(std::map<std::string, std::string> files, const std::vector<std::string>& expected) {
  std::vector<std::string> places;
  for (const char* name : {"s.voml", "other.voml"}) {
    if (!files.contains(name)) continue;
    for (const std::string& place : take_marks(name, files[name])) places.push_back(place);
  }
  REQUIRE(places.size() == expected.size());
  std::vector<std::string> full;
  for (std::size_t i = 0; i < places.size(); ++i) full.push_back(places[i] + expected[i]);
  CHECK(fmt::format("{}", fmt::join(compile(files).messages, "\n")) == fmt::format("{}", fmt::join(full, "\n")));
}

inline void check_body(const std::string& body, const std::vector<std::string>& expected,
                       const std::string& functions = "") {
  CAPTURE(body);
  check_marked({{"s.voml", scene_of(body, functions)}}, expected);
}

/// The snippet of a body without fault.
inline Snippet snippet_of(const std::string& body, const std::string& functions = "") {
  Outcome outcome = compile({{"s.voml", scene_of(body, functions)}});
  CAPTURE(body);
  CHECK(outcome.messages == std::vector<std::string>{});
  REQUIRE(outcome.snippets.size() == 1);
  REQUIRE(outcome.snippets[0].has_value());
  return *outcome.snippets[0];
}

inline double value_of(const std::string& body, glm::dvec3 p = {0.25, -0.5, 0.75}, const std::string& functions = "") {
  return snippet_of(body, functions).evaluate(p, 0.0).f;
}

}  // namespace dmvv::tests
