#include "authoring/text_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "authoring/gunzip.h"
#include "base/limits.h"
#include "base/text.h"

namespace dmvv::authoring {
namespace {

/// Why the bytes are no text that can be read; null if they are.
const char* why_unreadable(std::string_view bytes) {
  if (bytes.size() > max_file_bytes) return "the file is 4 GiB or longer";
  if (is_gzip(bytes)) return "the file is compressed; unpack it first: gunzip";
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    return "the file is UTF-16; convert it to UTF-8: iconv -f UTF-16 -t UTF-8";
  return nullptr;
}

}  // namespace

std::optional<SourceId> add_text(const std::string& path, std::string_view bytes, Code syntax,
                                 Diagnostics& diagnostics) {
  if (const char* const why = why_unreadable(bytes)) {
    diagnostics.report(syntax, {diagnostics.add_source(path, ""), 0, 0}, why);
    return std::nullopt;
  }
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  std::string text(bytes);
  for (std::size_t at = text.find('\r'); at != text.npos; at = text.find('\r', at + 1))
    if (at + 1 == text.size() || text[at + 1] != '\n') text[at] = '\n';
  return diagnostics.add_source(path, std::move(text));
}

std::string decimal_point_hint(std::string_view text) {
  std::string pointed(trim(text));
  if (std::ranges::count(pointed, ',') != 1) return {};
  std::ranges::replace(pointed, ',', '.');
  if (!std::holds_alternative<double>(parse_number(pointed))) return {};
  return fmt::format("; write {}, with a point", pointed);
}

}  // namespace dmvv::authoring
