// VOML text -> the same document in its canonical layout (spec/voml.md, section 9).
#pragma once

#include <optional>
#include <string>

#include "base/diagnostics.h"

namespace dmvv::voml {

/// Lays out the registered text of `source`: one element a line, two blanks a level, attributes in the order of the
/// specification's table and wrapped at 120 columns, UTF-8 without a byte order mark, line ends LF. A declaration of
/// another encoding becomes encoding="UTF-8".
///
/// Kept: comments (their further lines move with the first), processing instructions, DOCTYPE, entities, the text and
/// CDATA of elements byte for byte, an empty line between two elements, and short elements that stand on one line.
/// Formatting twice gives what formatting once gives; the scene is the same, but for the places of its parts.
/// Errors: E0002..E0005 and E0101, as reading reports them; then the result is empty. Names and values are not judged.
/// Cost: linear; some five copies of the text.
std::optional<std::string> format_document(SourceId source, Diagnostics& diagnostics);

}  // namespace dmvv::voml
