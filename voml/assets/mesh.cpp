#include "voml/assets/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <new>
#include <numeric>
#include <span>

#include "base/encoding.h"
#include "base/text.h"
#include "voml/assets/mesh_readers.h"

namespace dmvv::voml {

// ---- text ----

namespace {

bool parts_tokens(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool is_line_end(char c) { return c == '\n' || c == '\r'; }

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// A token as messages show it: short, and free of control characters.
std::string quoted(std::string_view token) {
  constexpr std::size_t longest = 32;
  std::string shown(token.substr(0, longest));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
  }
  return "'" + shown + (token.size() > longest ? "...'" : "'");
}

}  // namespace

std::string_view mark_of(std::string_view bytes) {
  return encoding_of_mark(bytes) == "UTF-8" ? bytes.substr(0, 3) : "";
}

bool equals_ignoring_case(std::string_view word, std::string_view lower_word) {
  return std::ranges::equal(word, lower_word, {}, lower);
}

std::size_t TextCursor::continuation_length() const {
  if (!continuation_ || text_[position_] != '\\') return 0;
  const std::string_view after = text_.substr(position_ + 1, 2);
  if (after.starts_with("\r\n")) return 3;
  return !after.empty() && is_line_end(after[0]) ? 2 : 0;
}

void TextCursor::skip_blanks() {
  while (position_ < text_.size()) {
    const std::size_t step = parts_tokens(text_[position_]) ? 1 : continuation_length();
    if (step == 0) return;
    position_ += step;
  }
}

void TextCursor::skip_space() {
  while (position_ < text_.size() && (parts_tokens(text_[position_]) || is_line_end(text_[position_]))) ++position_;
}

bool TextCursor::at_line_end() {
  skip_blanks();
  return at_end() || is_line_end(text_[position_]);
}

bool TextCursor::at_comment() {
  skip_blanks();
  return !at_end() && text_[position_] == '#';
}

void TextCursor::next_line() {
  while (position_ < text_.size() && !is_line_end(text_[position_])) {
    position_ += std::max<std::size_t>(1, continuation_length());
  }
  if (text_.substr(position_, 2) == "\r\n") ++position_;
  if (!at_end()) ++position_;
}

std::string_view TextCursor::token() {
  skip_blanks();
  token_begin_ = position_;
  while (position_ < text_.size() && !parts_tokens(text_[position_]) && !is_line_end(text_[position_]) &&
         continuation_length() == 0) {
    ++position_;
  }
  return text_.substr(token_begin_, position_ - token_begin_);
}

std::string_view TextCursor::rest_of_line() {
  skip_blanks();
  token_begin_ = position_;
  while (position_ < text_.size() && !is_line_end(text_[position_])) ++position_;
  std::string_view rest = text_.substr(token_begin_, position_ - token_begin_);
  while (!rest.empty() && parts_tokens(rest.back())) rest.remove_suffix(1);
  return rest;
}

double TextCursor::number(std::string_view what) {
  const std::string_view word = token();
  if (word.empty()) refuse_missing(what);
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range) {
    refuse_token(Code::mesh_number_not_finite,
                 fmt::format("{} is {}, beyond the range of double precision", what, quoted(word)));
  }
  if (error != std::errc() || end != digits.data() + digits.size()) {
    refuse_token(Code::mesh_syntax,
                 fmt::format("expected {}, a number, found {}{}", what, quoted(word), hint_at_number(word)));
  }
  if (!std::isfinite(value)) {
    refuse_token(Code::mesh_number_not_finite, fmt::format("{} is {}, not a finite number", what, quoted(word)));
  }
  return value;
}

std::int64_t TextCursor::integer(std::string_view what) {
  const std::string_view word = token();
  if (word.empty()) refuse_missing(what);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) {
    refuse_token(Code::mesh_syntax, fmt::format("expected {}, an integer, found {}", what, quoted(word)));
  }
  return value;
}

void TextCursor::split_token(std::size_t n) { position_ = token_begin_ + n; }

MeshFault TextCursor::remark(Code code, std::string message) const {
  return {code, token_begin_, position_, std::move(message)};
}

void TextCursor::refuse_token(Code code, std::string message) const {
  throw MeshFault{code, token_begin_, position_, std::move(message)};
}

void TextCursor::refuse_here(Code code, std::string message) const {
  throw MeshFault{code, position_, position_, std::move(message)};
}

void TextCursor::refuse_missing(std::string_view what) const {
  if (at_end()) refuse_here(Code::mesh_truncated, fmt::format("the file ends where {} is expected", what));
  refuse_here(Code::mesh_syntax, fmt::format("the line ends where {} is expected", what));
}

// ---- geometry ----

void append_fan(std::span<const std::uint32_t> corners, std::vector<glm::uvec3>& triangles) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) triangles.emplace_back(corners[0], corners[i], corners[i + 1]);
}

void append_strip(std::span<const std::uint32_t> corners, std::vector<glm::uvec3>& triangles) {
  for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
    const std::uint32_t a = corners[i], b = corners[i + 1], c = corners[i + 2];
    if (a == b || b == c || c == a) continue;
    triangles.push_back(i % 2 == 0 ? glm::uvec3(a, b, c) : glm::uvec3(b, a, c));
  }
}

namespace {

std::uint64_t hash(const glm::dvec3& p) {
  std::uint64_t h = 0;
  for (int axis = 0; axis < 3; ++axis) {
    h ^= std::bit_cast<std::uint64_t>(p[axis] + 0.0);  // -0 and 0 are equal
    h *= 0x9e3779b97f4a7c15u;
    h ^= h >> 32;
  }
  return h;
}

}  // namespace

std::vector<std::uint32_t> first_of_equal(std::span<const glm::dvec3> positions) {
  constexpr std::uint32_t vacant = 0xffffffffu;
  std::vector<std::uint32_t> slots(std::bit_ceil(2 * positions.size() + 1), vacant);
  const std::size_t mask = slots.size() - 1;
  std::vector<std::uint32_t> first(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    std::size_t slot = hash(positions[i]) & mask;
    while (slots[slot] != vacant && positions[slots[slot]] != positions[i]) slot = (slot + 1) & mask;
    if (slots[slot] == vacant) slots[slot] = i;
    first[i] = slots[slot];
  }
  return first;
}

Bounds bounds(const Mesh& mesh) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Bounds box{glm::dvec3(infinity), glm::dvec3(-infinity)};
  for (const glm::uvec3& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      box.lo = glm::min(box.lo, mesh.positions[triangle[corner]]);
      box.hi = glm::max(box.hi, mesh.positions[triangle[corner]]);
    }
  }
  return box;
}

EdgeFaults find_edge_faults(const Mesh& mesh) {
  const std::vector<std::uint32_t> first = first_of_equal(mesh.positions);
  const auto for_each_edge = [&](auto body) {
    for (const glm::uvec3& triangle : mesh.triangles) {
      const glm::uvec3 v(first[triangle.x], first[triangle.y], first[triangle.z]);
      if (v.x == v.y || v.y == v.z || v.z == v.x) continue;  // no area: its neighbours meet each other
      for (int corner = 0; corner < 3; ++corner) body(v[corner], v[(corner + 1) % 3]);
    }
  };

  // Every edge stands with its smaller vertex: twice the larger one, and in which direction it is passed.
  std::vector<std::size_t> begin(mesh.positions.size() + 1, 0);
  for_each_edge([&](std::uint32_t a, std::uint32_t b) { ++begin[std::min(a, b) + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint64_t> edges(begin.back());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for_each_edge([&](std::uint32_t a, std::uint32_t b) {
    edges[next[std::min(a, b)]++] = std::uint64_t{std::max(a, b)} << 1 | (a < b ? 1u : 0u);
  });

  EdgeFaults faults;
  const auto count = [&](EdgeCount& kind, std::size_t a, std::uint64_t b) {
    if (kind.count++ == 0) kind.from = mesh.positions[a], kind.to = mesh.positions[b];
  };
  for (std::size_t v = 0; v + 1 < begin.size(); ++v) {
    const std::span of_vertex(edges.data() + begin[v], edges.data() + begin[v + 1]);
    std::ranges::sort(of_vertex);
    for (std::size_t e = 0, end = 0; e < of_vertex.size(); e = end) {
      const std::uint64_t other = of_vertex[e] >> 1;
      while (end < of_vertex.size() && of_vertex[end] >> 1 == other) ++end;
      ++faults.edges;
      if (end - e == 1) count(faults.open, v, other);
      if (end - e == 2 && of_vertex[e] == of_vertex[e + 1]) count(faults.opposed, v, other);
      if (end - e > 2) count(faults.crowded, v, other);
    }
  }
  return faults;
}

std::vector<std::string> describe(const EdgeFaults& edges) {
  std::vector<std::string> lines;
  const auto line = [&](const EdgeCount& kind, std::string_view one, std::string_view several) {
    if (kind.count == 0) return;
    lines.push_back(fmt::format("{} {}, {} ({:.6g} {:.6g} {:.6g}) to ({:.6g} {:.6g} {:.6g})", kind.count,
                                kind.count == 1 ? one : several, kind.count == 1 ? "from" : "the first from",
                                kind.from.x, kind.from.y, kind.from.z, kind.to.x, kind.to.y, kind.to.z));
  };
  line(edges.open, "open edge, with a triangle on one side only", "open edges, with a triangle on one side only");
  line(edges.opposed, "edge lies between two triangles wound against each other",
       "edges lie between two triangles wound against each other");
  line(edges.crowded, "edge has more than two triangles", "edges have more than two triangles");
  return lines;
}

std::vector<bool> outward_triangles(const Mesh& mesh) {
  std::vector<std::uint32_t> part =
      first_of_equal(mesh.positions);  // each vertex points to another one of its part, or itself
  const auto part_of = [&](std::uint32_t v) {
    while (part[v] != v) v = part[v] = part[part[v]];
    return v;
  };
  for (const glm::uvec3& t : mesh.triangles) {
    for (const std::uint32_t other : {t.y, t.z}) part[part_of(other)] = part_of(t.x);
  }
  std::vector<double> volumes(mesh.positions.size(), 0.0);  // six times
  const glm::dvec3 origin = mesh.positions[mesh.triangles.front().x];
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x] - origin, b = mesh.positions[t.y] - origin,
                     c = mesh.positions[t.z] - origin;
    volumes[part_of(t.x)] += glm::dot(a, glm::cross(b, c));
  }
  std::vector<bool> outward;
  outward.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) outward.push_back(volumes[part_of(t.x)] > 0.0);
  return outward;
}

Mesh standard_cube() {
  Mesh cube;
  for (int i = 0; i < 8; ++i) cube.positions.emplace_back(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
  const std::uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& face : faces) append_fan(face, cube.triangles);
  return cube;
}

// ---- files ----

namespace {

/// By its first line, which binary PLY has too.
bool looks_like_ply(std::string_view bytes) {
  bytes.remove_prefix(mark_of(bytes).size());
  return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

Mesh read_mesh(const std::string& path, std::string_view bytes, MeshWarnings& warnings) {
  const auto named = [&](std::string_view ending) {
    return path.size() >= ending.size() && equals_ignoring_case(std::string_view(path).substr(path.size() - 4), ending);
  };
  if (bytes.size() > 0xffffffffu) {
    throw MeshFault{.code = Code::mesh_too_large,
                    .message = fmt::format("the mesh has {} bytes; at most 4294967295 are read", bytes.size())};
  }
  if (looks_like_ply(bytes) || named(".ply")) return read_ply(bytes, warnings);
  if (looks_like_stl(bytes) || named(".stl")) return read_stl(bytes, warnings);
  if (looks_like_off(bytes) || named(".off")) return read_off(bytes, warnings);
  if (named(".obj")) return read_obj(bytes, warnings);
  throw MeshFault{.code = Code::mesh_unknown_format,
                  .message = "unknown mesh format; the formats read are OBJ (by its ending .obj), PLY, STL and OFF"};
}

void report(const MeshFault& fault, const std::string& path, std::string_view bytes, Diagnostics& diagnostics) {
  if (!fault.in_text) {
    diagnostics.report(fault.code, {diagnostics.add_source(path, {})},
                       fmt::format("{} (at byte {})", fault.message, fault.begin));
    return;
  }
  // The text up to the end of the line in question is all that a message can show.
  const std::size_t shown = std::min(bytes.find_first_of("\r\n", fault.end), bytes.size());
  const SourceId source = diagnostics.add_source(path, std::string(bytes.substr(0, shown)));
  diagnostics.report(fault.code,
                     {source, static_cast<std::uint32_t>(fault.begin), static_cast<std::uint32_t>(fault.end)},
                     fault.message);
}

/// Mesh texts in UTF-16 or UTF-32, as some programs redirect them into a file.
bool is_wide_text(std::string_view bytes) {
  const std::string_view encoding = encoding_of_mark(bytes);
  return !encoding.empty() && encoding != "UTF-8" && !looks_like_stl(bytes);
}

std::optional<Mesh> parse(const std::string& path, std::string_view bytes, Diagnostics& diagnostics) {
  try {
    MeshWarnings warnings;
    Mesh mesh = read_mesh(path, bytes, warnings);
    for (const MeshFault& warning : warnings) report(warning, path, bytes, diagnostics);
    if (!mesh.triangles.empty()) return mesh;
    throw MeshFault{.code = Code::mesh_without_triangles, .message = "the mesh has no triangle"};
  } catch (const MeshFault& refusal) {
    // A place in the data is worth naming only where there is one.
    const bool whole_file = refusal.code == Code::mesh_unknown_format || refusal.code == Code::mesh_too_large ||
                            refusal.code == Code::mesh_without_triangles;
    if (whole_file) {
      diagnostics.report(refusal.code, {diagnostics.add_source(path, {})}, refusal.message);
    } else {
      report(refusal, path, bytes, diagnostics);
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Mesh> parse_mesh(const std::string& path, std::string_view bytes, Diagnostics& diagnostics) {
  try {
    if (!is_wide_text(bytes)) return parse(path, bytes, diagnostics);
    const Decoded decoded = decode(bytes, encoding_of_mark(bytes)).value();
    if (decoded.fault.empty()) return parse(path, decoded.text, diagnostics);
    report({Code::mesh_syntax, decoded.text.size(), decoded.text.size(), decoded.fault}, path, decoded.text,
           diagnostics);
  } catch (const std::bad_alloc&) {
    diagnostics.report(Code::mesh_too_large, {diagnostics.add_source(path, {})},
                       fmt::format("a mesh file of {} bytes does not fit into memory", bytes.size()));
  }
  return std::nullopt;
}

}  // namespace dmvv::voml
