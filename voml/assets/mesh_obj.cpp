// Wavefront OBJ: of its keywords, the vertices (v) and polygons (f).
#include <fmt/format.h>

#include <charconv>

#include "voml/assets/mesh_readers.h"

namespace dmvv::voml {

namespace {

class ObjReader {
 public:
  ObjReader(std::string_view bytes, MeshWarnings& warnings)
      : text_(bytes, /*continuation=*/true), warnings_(warnings) {}

  Mesh read() {
    for (; !text_.at_end() && !ends_here(); text_.next_line()) read_line();
    for (const Forward& reference : forward_) {
      if (reference.vertex >= mesh_.positions.size()) refuse_range(reference);
    }
    return std::move(mesh_);
  }

 private:
  /// A corner that names a vertex which the file had not defined yet.
  struct Forward {
    std::uint64_t vertex;
    std::size_t begin, end;
  };

  /// At a zero or the end mark of old systems: bytes that a text is filled up with, and what follows, are passed over.
  bool ends_here() {
    const TextCursor start = text_;
    const std::string_view word = text_.token();
    const bool ends = !word.empty() && (word[0] == '\0' || word[0] == '\x1a');
    if (ends) {
      warnings_.push_back(
          text_.remark(Code::mesh_trailing_data,
                       fmt::format("the text ends here; {} bytes are passed over", word.size() + text_.remaining())));
    }
    text_ = start;
    return ends;
  }

  void read_line() {
    if (text_.at_line_end()) return;
    const std::string_view keyword = text_.token();
    if (keyword == "v") {
      read_vertex();
    } else if (keyword == "f") {
      read_face();
    } else if (keyword[0] != '#' && !((keyword[0] | 0x20) >= 'a' && (keyword[0] | 0x20) <= 'z')) {
      text_.refuse_token(Code::mesh_syntax, "a line of an OBJ file begins with a keyword or '#'");
    }
  }

  /// True at the line's end or at a comment behind the data.
  bool data_ends() { return text_.at_line_end() || text_.at_comment(); }

  void read_vertex() {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = text_.number("a coordinate");
    while (!data_ends()) text_.number("a weight or colour");  // no meaning here, but must be what the format says
    mesh_.positions.push_back(p);
  }

  void read_face() {
    corners_.clear();
    while (!data_ends()) corners_.push_back(read_corner(text_.token()));
    if (corners_.size() < 3) {
      text_.refuse_here(Code::mesh_syntax, fmt::format("a face has {} corners, it needs at least 3", corners_.size()));
    }
    append_fan(corners_, mesh_.triangles);
  }

  /// "v", "v/vt", "v//vn" or "v/vt/vn"; only v counts.
  std::uint32_t read_corner(std::string_view word) {
    const char* const end = word.data() + word.size();
    std::int64_t index = 0, ignored = 0;
    std::from_chars_result at = std::from_chars(word.data(), end, index);
    for (int part = 0; part < 2 && at.ec == std::errc() && at.ptr != end && *at.ptr == '/'; ++part) {
      const char* const next = at.ptr + 1;
      if (next == end || *next == '/') {
        at.ptr = next;
      } else {
        at = std::from_chars(next, end, ignored);
      }
    }
    if (at.ec != std::errc() || at.ptr != end) {
      text_.refuse_token(Code::mesh_syntax, "a corner of a face is v, v/vt, v//vn or v/vt/vn, all integers");
    }
    return resolve(index);
  }

  /// 1-based from the start, or negative from the latest vertex.
  std::uint32_t resolve(std::int64_t index) {
    const auto count = static_cast<std::int64_t>(mesh_.positions.size());
    if (index == 0 || index < -count) {
      text_.refuse_token(Code::mesh_index_out_of_range,
                         fmt::format("vertex {} of {} defined before this face; indices count from 1, or from -1 "
                                     "backwards",
                                     index, count));
    }
    const auto vertex = static_cast<std::uint64_t>(index > 0 ? index - 1 : count + index);
    if (index > count) forward_.push_back({vertex, text_.token_begin(), text_.position()});
    return static_cast<std::uint32_t>(vertex);
  }

  [[noreturn]] void refuse_range(const Forward& reference) const {
    throw MeshFault{
        Code::mesh_index_out_of_range, reference.begin, reference.end,
        fmt::format("a face names vertex {}, the file has {}", reference.vertex + 1, mesh_.positions.size())};
  }

  TextCursor text_;
  MeshWarnings& warnings_;
  Mesh mesh_;
  std::vector<std::uint32_t> corners_;
  std::vector<Forward> forward_;
};

}  // namespace

Mesh read_obj(std::string_view bytes, MeshWarnings& warnings) { return ObjReader(bytes, warnings).read(); }

}  // namespace dmvv::voml
