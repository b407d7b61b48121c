// What the tests of the mesh formats share: parsing with the diagnostics at hand, and binary files written by hand.
#pragma once

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voml/assets/mesh.h"

namespace dmvv::tests {

struct Parsed {
  std::optional<voml::Mesh> mesh;
  Diagnostics diagnostics;
};

inline Parsed parse(const std::string& path, std::string_view bytes) {
  Parsed parsed;
  parsed.mesh = voml::parse_mesh(path, bytes, parsed.diagnostics);
  return parsed;
}

/// The mesh of a file that must be fine.
inline voml::Mesh mesh_of(const std::string& path, std::string_view bytes) {
  Parsed parsed = parse(path, bytes);
  INFO(parsed.diagnostics.render());
  REQUIRE(parsed.mesh.has_value());
  CHECK(parsed.diagnostics.all().empty());
  return std::move(*parsed.mesh);
}

/// The mesh of a file whose one diagnostic is this warning.
inline voml::Mesh mesh_with_warning(const std::string& path, std::string_view bytes, Code code,
                                    const std::string& message) {
  Parsed parsed = parse(path, bytes);
  INFO(parsed.diagnostics.render());
  REQUIRE(parsed.mesh.has_value());
  REQUIRE(parsed.diagnostics.all().size() == 1);
  const Diagnostic& warning = parsed.diagnostics.all()[0];
  CHECK(warning.severity == Severity::warning);
  CHECK(info(warning.code).name == info(code).name);
  CHECK(warning.message == message);
  return std::move(*parsed.mesh);
}

/// The one diagnostic of a file that must be refused.
inline Diagnostic refusal_of(const Parsed& parsed) {
  CHECK_FALSE(parsed.mesh.has_value());
  REQUIRE(parsed.diagnostics.all().size() == 1);
  CHECK(parsed.diagnostics.all()[0].severity == Severity::error);
  return parsed.diagnostics.all()[0];
}

/// Checks that a text is refused with this code at this line and column (both 1-based).
inline void check_refused_at(const std::string& path, std::string_view bytes, Code code, std::uint32_t line,
                             std::uint32_t column) {
  CAPTURE(bytes);
  const Parsed parsed = parse(path, bytes);
  const Diagnostic refusal = refusal_of(parsed);
  CHECK(info(refusal.code).name == info(code).name);
  CHECK(parsed.diagnostics.source_name(refusal.span.source) == path);
  const LineColumn at = parsed.diagnostics.locate(refusal.span.source, refusal.span.begin);
  CHECK(at.line == line);
  CHECK(at.column == column);
}

/// Checks that binary data are refused with this code at this byte.
inline void check_refused_at_byte(const std::string& path, std::string_view bytes, Code code, std::size_t offset) {
  const Parsed parsed = parse(path, bytes);
  const Diagnostic refusal = refusal_of(parsed);
  CAPTURE(refusal.message);
  CHECK(info(refusal.code).name == info(code).name);
  CHECK(refusal.message.ends_with("(at byte " + std::to_string(offset) + ")"));
}

/// Appends the bytes of a number in either order.
template <class T>
void put(std::string& bytes, T value, std::endian order = std::endian::little) {
  std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
  if (order != std::endian::native) raw.assign(raw.rbegin(), raw.rend());
  bytes += raw;
}

using Positions = std::vector<glm::dvec3>;
using Triangles = std::vector<glm::uvec3>;

}  // namespace dmvv::tests
