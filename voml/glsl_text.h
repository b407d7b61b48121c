// Inside voml: text of a file -> GlslText, byte for byte with its place.
#pragma once

#include <string_view>

#include "voml/scene.h"

namespace dmvv::voml {

/// Appends the text that `part` of a file stands for: line ends as LF and, if `has_entities` (no CDATA), entities
/// resolved. An entity that XML does not define stays as it is written.
void append_text(GlslText& text, std::string_view file, Span part, bool has_entities);

/// Appends the line ends of a part that is left out.
void append_line_ends(GlslText& text, std::string_view file, Span part);

}  // namespace dmvv::voml
