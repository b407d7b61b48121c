// STL: facets without shared vertices, as text (solid ... endsolid) or binary (80 bytes of header, a count, 50 bytes a
// facet). Corners with equal coordinates become one vertex. Normals are redundant and are not read.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <optional>

#include "voml/assets/mesh_readers.h"

namespace dmvv::voml {

namespace {

constexpr std::size_t header_bytes = 84;  // 80 of free text, then the count
constexpr std::size_t facet_bytes = 50;   // normal and three corners as float32, two bytes of attributes

std::uint32_t little_endian(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
  return value;
}

/// The bytes that a binary file promises to have; nothing if it ends within the header.
std::optional<std::uint64_t> promised_bytes(std::string_view bytes) {
  if (bytes.size() < header_bytes) return std::nullopt;
  return header_bytes + std::uint64_t{facet_bytes} * little_endian(bytes, 80);
}

/// Headers of binary files may begin with "solid", too. The count's four bytes tell: as text they would promise more
/// than 4 GiB, as the count of a file that can exist they hold a zero byte or agree with the file's length.
bool is_text(std::string_view bytes) {
  bytes.remove_prefix(mark_of(bytes).size());
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos || !equals_ignoring_case(bytes.substr(start, 5), "solid")) return false;
  if (promised_bytes(bytes) == bytes.size()) return false;
  return bytes.substr(0, header_bytes).find('\0') == std::string_view::npos;
}

/// Where a binary file begins: behind a byte order mark, unless the file's length says that the mark is the header's.
std::size_t binary_begin(std::string_view bytes) {
  const std::size_t mark = mark_of(bytes).size();
  const auto with_mark = promised_bytes(bytes), without = promised_bytes(bytes.substr(mark));
  if (mark == 0 || !without || with_mark == bytes.size()) return 0;
  const std::size_t size = bytes.size() - mark;
  return without == size || (*without<size&& * with_mark> bytes.size()) ? mark : 0;
}

Mesh merged(std::vector<glm::dvec3> corners) {
  const std::vector<std::uint32_t> first = first_of_equal(corners);
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
  StlTextReader(std::string_view bytes, MeshWarnings& warnings) : bytes_(bytes), text_(bytes), warnings_(warnings) {}

  Mesh read() {
    expect("solid");
    for (bool more = true; more;) {
      read_solid();
      text_.skip_space();
      more = !text_.at_end() && (equals_ignoring_case(text_.token(), "solid") || !pass_over_rest());
    }
    return merged(std::move(corners_));
  }

 private:
  /// What stands behind the last solid, from the token read last on; refused if it holds facets: then a solid's keyword
  /// is misspelt. True.
  bool pass_over_rest() {
    const std::size_t begin = text_.token_begin();
    const TextCursor here = text_;
    for (; !text_.at_end(); text_.skip_space()) {
      if (equals_ignoring_case(text_.token(), "vertex")) here.refuse_token(Code::mesh_syntax, "expected 'solid'");
    }
    warnings_.push_back(
        here.remark(Code::mesh_trailing_data,
                    fmt::format("{} bytes behind the last solid are passed over", bytes_.size() - begin)));
    return true;
  }

  /// From behind its keyword.
  void read_solid() {
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

  std::string_view bytes_;
  TextCursor text_;
  MeshWarnings& warnings_;
  std::vector<glm::dvec3> corners_;
};

[[noreturn]] void refuse(Code code, std::size_t offset, std::string message) {
  throw MeshFault{code, offset, offset, std::move(message), /*in_text=*/false};
}

/// `begin`: where the bytes stand in the file.
Mesh read_binary(std::string_view bytes, std::size_t begin, MeshWarnings& warnings) {
  const auto promised = promised_bytes(bytes);
  if (!promised) {
    refuse(Code::mesh_truncated, begin + bytes.size(),
           fmt::format("the STL file has {} bytes, its header alone takes {}", bytes.size(), header_bytes));
  }
  const std::uint32_t count = little_endian(bytes, 80);
  const bool holds_more = *promised < bytes.size();
  if (*promised > bytes.size() || (count == 0 && holds_more)) {
    refuse(holds_more ? Code::mesh_syntax : Code::mesh_truncated, begin + 80,
           fmt::format("the STL file promises {} triangles, {} bytes in all, and has {} bytes", count, *promised,
                       bytes.size()));
  }
  if (holds_more) {
    const std::size_t end = begin + static_cast<std::size_t>(*promised);
    warnings.push_back(
        {Code::mesh_trailing_data, end, end,
         fmt::format("the STL file promises {} triangles; the {} bytes behind the last one are passed over", count,
                     bytes.size() - *promised),
         /*in_text=*/false});
  }
  std::vector<glm::dvec3> corners(std::size_t{3} * count);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t offset = header_bytes + i / 3 * facet_bytes + 12 + i % 3 * 12 + axis * 4;
      const float value = std::bit_cast<float>(little_endian(bytes, offset));
      if (!std::isfinite(value)) {
        refuse(Code::mesh_number_not_finite, begin + offset,
               fmt::format("a coordinate of triangle {} is {}", i / 3, value));
      }
      corners[i][static_cast<int>(axis)] = value;
    }
  }
  return merged(std::move(corners));
}

}  // namespace

bool looks_like_stl(std::string_view bytes) {
  const std::string_view binary = bytes.substr(binary_begin(bytes));
  return is_text(bytes) || promised_bytes(binary) == binary.size();
}

Mesh read_stl(std::string_view bytes, MeshWarnings& warnings) {
  if (is_text(bytes)) return StlTextReader(bytes, warnings).read();
  const std::size_t begin = binary_begin(bytes);
  return read_binary(bytes.substr(begin), begin, warnings);
}

}  // namespace dmvv::voml
