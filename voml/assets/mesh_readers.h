// Private to voml/assets/mesh*.cpp: what the readers of the mesh formats share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "voml/assets/mesh.h"

namespace dmvv::voml {

/// What parse_mesh turns into a diagnostic: thrown by the readers at the first error, since nothing after it can be
/// trusted; collected where it is a warning. Bytes [begin, end) of a text, or the offset `begin` into binary data.
struct MeshFault {
  Code code;
  std::size_t begin = 0;
  std::size_t end = 0;
  std::string message;
  bool in_text = true;
};

using MeshWarnings = std::vector<MeshFault>;

/// The UTF-8 byte order mark that bytes begin with, or nothing.
std::string_view mark_of(std::string_view bytes);

/// Walks through a text token by token, from behind its byte order mark. Tokens are separated by blanks; a token never
/// holds a line's end.
class TextCursor {
 public:
  /// With `continuation`, a backslash at the end of a line counts as a blank (OBJ).
  explicit TextCursor(std::string_view text, bool continuation = false)
      : text_(text), continuation_(continuation), position_(mark_of(text).size()) {}

  bool at_end() const { return position_ == text_.size(); }
  std::size_t position() const { return position_; }
  std::size_t remaining() const { return text_.size() - position_; }
  std::size_t token_begin() const { return token_begin_; }

  void skip_blanks();               ///< within the line
  void skip_space();                ///< blanks and line ends
  bool at_line_end();               ///< after blanks; true at the end of the text
  bool at_comment();                ///< after blanks, at a '#'
  void next_line();                 ///< behind the line's end, continuations included
  void split_token(std::size_t n);  ///< the token read last ends after n bytes; the rest is read next
  std::string_view token();         ///< the next token of this line; empty at its end
  std::string_view rest_of_line();  ///< without the blanks around it

  /// The next token of this line as a finite number. `what` names it in messages: "a coordinate".
  double number(std::string_view what);
  /// The next token of this line as an integer.
  std::int64_t integer(std::string_view what);

  /// A warning at the token read last.
  MeshFault remark(Code code, std::string message) const;
  /// Refuses the token read last.
  [[noreturn]] void refuse_token(Code code, std::string message) const;
  /// Refuses the place where the cursor stands.
  [[noreturn]] void refuse_here(Code code, std::string message) const;

 private:
  std::size_t continuation_length() const;
  [[noreturn]] void refuse_missing(std::string_view what) const;

  std::string_view text_;
  bool continuation_;
  std::size_t position_;
  std::size_t token_begin_ = 0;
};

/// Adds the triangles (0, i, i + 1) of a polygon.
void append_fan(std::span<const std::uint32_t> corners, std::vector<glm::uvec3>& triangles);

/// Adds the triangles of a strip: corners i, i + 1, i + 2, every second one turned around. Those with a corner twice,
/// which join two strips, are left out.
void append_strip(std::span<const std::uint32_t> corners, std::vector<glm::uvec3>& triangles);

/// Equal case-insensitively; `lower` is in lower case.
bool equals_ignoring_case(std::string_view word, std::string_view lower);

// The formats. Each returns a mesh whose positions are finite and whose indices are in range, or throws MeshFault. A
// byte order mark in front of the bytes does not count.
Mesh read_obj(std::string_view bytes, MeshWarnings& warnings);
Mesh read_ply(std::string_view bytes, MeshWarnings& warnings);
Mesh read_stl(std::string_view bytes, MeshWarnings& warnings);
Mesh read_off(std::string_view bytes, MeshWarnings& warnings);

/// True if the bytes can only be an STL file: text that begins with "solid", or as long as a binary STL says it is.
bool looks_like_stl(std::string_view bytes);

/// True if the first word is the keyword of an OFF file.
bool looks_like_off(std::string_view bytes);

}  // namespace dmvv::voml
