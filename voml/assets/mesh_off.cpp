// OFF, the text format of Geomview: a keyword, the numbers of vertices, faces and edges, the vertices, the faces.
// Source: geomview.org/docs/html/OFF.html. Letters before OFF announce what else stands on the lines of the vertices.
#include <fmt/format.h>

#include "voml/assets/mesh_readers.h"

namespace dmvv::voml {

namespace {

/// The first word behind blank lines and comments.
std::string_view first_word(TextCursor& text) {
  for (text.skip_space(); text.at_comment(); text.skip_space()) text.next_line();
  return text.token();
}

/// The length of the keyword that a word begins with, 0 if there is none: "OFF", "COFF", "STCN4nOFF", any letters of
/// the format in front. Behind it the first count may stand without a blank ("OFF490926", as the ModelNet collection
/// has it).
std::size_t keyword_length(std::string_view word) {
  const std::size_t letters = word.find("OFF");
  if (letters == std::string_view::npos) return 0;
  if (word.substr(0, letters).find_first_not_of("STCN4n") != std::string_view::npos) return 0;
  const std::size_t length = letters + 3;
  return word.find_first_not_of("0123456789", length) == std::string_view::npos ? length : 0;
}

class OffReader {
 public:
  OffReader(std::string_view bytes, MeshWarnings& warnings) : text_(bytes), warnings_(warnings) {}

  Mesh read() {
    read_keyword();
    const std::size_t vertices = read_count("the number of vertices");
    const std::size_t faces = read_count("the number of faces");
    read_count("the number of edges");
    // Three digits and what parts them are the least of a vertex; a digit and a blank, of a face.
    check_promise(6 * vertices + 2 * faces);
    mesh_.positions.reserve(vertices);
    for (std::size_t i = 0; i < vertices; ++i) read_vertex();
    for (std::size_t i = 0; i < faces; ++i) read_face();
    skip();
    if (!text_.at_end()) {
      text_.token();
      warnings_.push_back(text_.remark(Code::mesh_trailing_data,
                                       fmt::format("text behind the last of {} faces is passed over", faces)));
    }
    return std::move(mesh_);
  }

 private:
  void skip() {
    for (text_.skip_space(); text_.at_comment(); text_.skip_space()) text_.next_line();
  }

  void read_keyword() {
    const TextCursor start = text_;
    const std::string_view word = first_word(text_);
    const std::size_t length = keyword_length(word);
    if (length == 0) {  // the format lets it be left out
      text_ = start;
      return;
    }
    const std::string_view letters = word.substr(0, length - 3);
    if (letters.find_first_of("4n") != std::string_view::npos) {
      text_.refuse_token(Code::mesh_syntax, "a mesh in a space of other than three dimensions");
    }
    more_on_vertex_lines_ = !letters.empty();
    text_.split_token(length);
    const TextCursor behind = text_;
    if (text_.token() == "BINARY") text_.refuse_token(Code::mesh_syntax, "binary OFF is not read; write it as text");
    text_ = behind;
  }

  std::size_t read_count(std::string_view what) {
    skip();
    const std::int64_t count = text_.integer(what);
    if (count < 0 || count > 0xffffffff) {
      text_.refuse_token(Code::mesh_syntax, fmt::format("{} is {}; it must be 0 to 4294967295", what, count));
    }
    return static_cast<std::size_t>(count);
  }

  void check_promise(std::size_t least_bytes) {
    if (least_bytes <= text_.remaining() + 1) return;  // the last blank may be missing
    text_.refuse_here(Code::mesh_truncated,
                      fmt::format("the counts promise at least {} bytes, {} are left", least_bytes, text_.remaining()));
  }

  void read_vertex() {
    skip();
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      skip();
      p[axis] = text_.number("a coordinate");
    }
    if (more_on_vertex_lines_) read_numbers_of_line("a normal, colour or texture coordinate");
    mesh_.positions.push_back(p);
  }

  void read_face() {
    skip();
    const std::int64_t count = text_.integer("the number of a face's corners");
    if (count < 1) {
      text_.refuse_token(Code::mesh_syntax, fmt::format("a face has {} corners, it needs at least 1", count));
    }
    corners_.clear();
    for (std::int64_t i = 0; i < count; ++i) {
      skip();
      corners_.push_back(read_corner());
    }
    append_fan(corners_, mesh_.triangles);  // none of points and edges, which the format has too
    read_numbers_of_line("a part of a colour");
  }

  std::uint32_t read_corner() {
    const std::int64_t index = text_.integer("a corner");
    const auto count = static_cast<std::int64_t>(mesh_.positions.size());
    if (index < 0 || index >= count) {
      text_.refuse_token(Code::mesh_index_out_of_range,
                         fmt::format("a face names vertex {}; the file has {}, counted from 0", index, count));
    }
    return static_cast<std::uint32_t>(index);
  }

  /// Without meaning here, but they must be what the format says.
  void read_numbers_of_line(std::string_view what) {
    while (!text_.at_line_end() && !text_.at_comment()) text_.number(what);
  }

  TextCursor text_;
  MeshWarnings& warnings_;
  Mesh mesh_;
  std::vector<std::uint32_t> corners_;
  bool more_on_vertex_lines_ = false;
};

}  // namespace

Mesh read_off(std::string_view bytes, MeshWarnings& warnings) { return OffReader(bytes, warnings).read(); }

bool looks_like_off(std::string_view bytes) {
  TextCursor text(bytes);
  return keyword_length(first_word(text)) != 0;
}

}  // namespace dmvv::voml
