// STL: facets without shared vertices, as text (solid ... endsolid) or binary (80 bytes of header, a count, 50 bytes a
// facet). Corners with equal coordinates become one vertex. Normals are redundant and are not read.
#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "voml/mesh_readers.h"

namespace dmvv::voml {

namespace {

constexpr std::size_t header_bytes = 84;  // 80 of free text, then the count
constexpr std::size_t facet_bytes = 50;   // normal and three corners as float32, two bytes of attributes

std::uint32_t little_endian(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
  return value;
}

std::uint64_t promised_bytes(std::string_view bytes) {
  return header_bytes + std::uint64_t{facet_bytes} * little_endian(bytes, 80);
}

/// Headers of binary files may begin with "solid", too. The count's four bytes tell: as text they would promise more
/// than 4 GiB, as the count of a file that can exist they hold a zero byte or agree with the file's length.
bool is_text(std::string_view bytes) {
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos || !equals_ignoring_case(bytes.substr(start, 5), "solid")) return false;
  if (bytes.size() >= header_bytes && promised_bytes(bytes) == bytes.size()) return false;
  return bytes.substr(0, header_bytes).find('\0') == std::string_view::npos;
}

Mesh merged(std::vector<glm::dvec3> corners) {
  const std::vector<std::uint32_t> first = weld(corners);
  std::vector<std::uint32_t> vertex(corners.size());
  Mesh mesh;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (first[i] != i) continue;
    vertex[i] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(corners[i]);
  }
  mesh.triangles.reserve(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    mesh.triangles.emplace_back(vertex[first[i]], vertex[first[i + 1]], vertex[first[i + 2]]);
  }
  return mesh;
}

class StlTextReader {
 public:
  explicit StlTextReader(std::string_view bytes) : text_(bytes) {}

  Mesh read() {
    for (text_.skip_space(); !text_.at_end(); text_.skip_space()) read_solid();
    return merged(std::move(corners_));
  }

 private:
  void read_solid() {
    expect("solid");
    text_.rest_of_line();  // its name
    while (!take_either("facet", "endsolid")) read_facet();
    text_.rest_of_line();
  }

  void read_facet() {
    for (int i = 0; i < 4; ++i) next_word("'normal' and its three numbers");
    expect("outer");
    expect("loop");
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      glm::dvec3 p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = text_.number("a coordinate");
      corners_.push_back(p);
    }
    expect("endloop");
    expect("endfacet");
  }

  std::string_view next_word(std::string_view expected) {
    text_.skip_space();
    if (text_.at_end()) {
      text_.refuse_here(Code::mesh_truncated, fmt::format("the file ends where {} is expected", expected));
    }
    return text_.token();
  }

  void expect(std::string_view keyword) {
    if (!equals_ignoring_case(next_word(fmt::format("'{}'", keyword)), keyword)) {
      text_.refuse_token(Code::mesh_syntax, fmt::format("expected '{}'", keyword));
    }
  }

  /// Reads one of two keywords; true if it was the second.
  bool take_either(std::string_view first, std::string_view second) {
    const std::string_view word = next_word(fmt::format("'{}' or '{}'", first, second));
    if (equals_ignoring_case(word, first)) return false;
    if (equals_ignoring_case(word, second)) return true;
    text_.refuse_token(Code::mesh_syntax, fmt::format("expected '{}' or '{}'", first, second));
  }

  TextCursor text_;
  std::vector<glm::dvec3> corners_;
};

[[noreturn]] void refuse(Code code, std::size_t offset, std::string message) {
  throw MeshRefusal{code, offset, offset, std::move(message), /*in_text=*/false};
}

Mesh read_binary(std::string_view bytes) {
  if (bytes.size() < header_bytes) {
    refuse(Code::mesh_truncated, bytes.size(),
           fmt::format("the STL file has {} bytes, its header alone takes {}", bytes.size(), header_bytes));
  }
  const std::uint32_t count = little_endian(bytes, 80);
  if (promised_bytes(bytes) != bytes.size()) {
    refuse(promised_bytes(bytes) > bytes.size() ? Code::mesh_truncated : Code::mesh_syntax, 80,
           fmt::format("the STL file promises {} triangles, {} bytes in all, and has {} bytes", count,
                       promised_bytes(bytes), bytes.size()));
  }
  std::vector<glm::dvec3> corners(std::size_t{3} * count);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t offset = header_bytes + i / 3 * facet_bytes + 12 + i % 3 * 12 + axis * 4;
      const float value = std::bit_cast<float>(little_endian(bytes, offset));
      if (!std::isfinite(value)) {
        refuse(Code::mesh_number_not_finite, offset, fmt::format("a coordinate of triangle {} is {}", i / 3, value));
      }
      corners[i][static_cast<int>(axis)] = value;
    }
  }
  return merged(std::move(corners));
}

}  // namespace

bool looks_like_stl(std::string_view bytes) {
  return is_text(bytes) || (bytes.size() >= header_bytes && promised_bytes(bytes) == bytes.size());
}

Mesh read_stl(std::string_view bytes) { return is_text(bytes) ? StlTextReader(bytes).read() : read_binary(bytes); }

}  // namespace dmvv::voml
