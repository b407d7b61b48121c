// Inside voml: texts in the encodings that people's files have, as UTF-8.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "base/diagnostics.h"

namespace dmvv {

/// The offset of the first byte that is no part of a UTF-8 character, or nothing. Overlong forms, surrogates and what
/// lies beyond U+10FFFF are no UTF-8. Source: Unicode 15, table 3-7. Cost: linear.
std::optional<std::size_t> first_not_utf8(std::string_view bytes);

/// The encoding that a byte order mark stands for: "UTF-8", "UTF-16LE", "UTF-16BE", "UTF-32LE", "UTF-32BE"; empty
/// without one.
std::string_view encoding_of_mark(std::string_view bytes);

/// A text as UTF-8; a byte order mark stays in it. If it has a fault, the text ends before that, and `fault` says what
/// is wrong there.
struct Decoded {
  std::string text;
  std::string fault;
};

/// Converts by the system's iconv. Nothing if it does not know the encoding; names are those of XML: letters, digits
/// and
/// "._-". Cost: linear.
std::optional<Decoded> decode(std::string_view bytes, std::string_view encoding);

/// Turns the bytes of a registered XML file into UTF-8, in place. Which encoding they have say, in this order: a byte
/// order mark; how "<" is written (UTF-16 and UTF-32 without a mark); the XML declaration; else they are UTF-8. A
/// declaration that the bytes contradict gives W0010.
/// Source: XML 1.0, appendix F. Errors: E0003 at the byte, E0010; then the result is false.
bool make_utf8(SourceId source, Diagnostics& diagnostics);

/// The same for a file that holds numbers and has no declaration: UTF-16 and UTF-32 are converted if they have a byte
/// order mark, other bytes stay what they are. Errors: E0003; then the result is false.
bool make_utf8_by_mark(SourceId source, Diagnostics& diagnostics);

}  // namespace dmvv
