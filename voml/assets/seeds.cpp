// Seed, rotate and scale files: three numbers a line.
#include "voml/assets/seeds.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/encoding.h"
#include "base/limits.h"
#include "base/text.h"

namespace dmvv::voml {
namespace {

/// Walks the lines of a text that hold something: without comments, not blank.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {
    if (text_.starts_with("\xef\xbb\xbf")) next_ = 3;
  }

  /// The next line that holds something, without its comment and the blanks around it; false at the end.
  bool next(std::string_view& line) {
    while (next_ < text_.size()) {
      const std::size_t end = std::min(text_.find_first_of("\r\n", next_), text_.size());
      line = text_.substr(next_, end - next_);
      next_ = end + 1;
      line = trim(line.substr(0, line.find('#')));
      if (!line.empty()) return true;
    }
    return false;
  }

  Span span(std::string_view part, SourceId source) const {
    const auto begin = static_cast<std::uint32_t>(part.data() - text_.data());
    return {source, begin, begin + static_cast<std::uint32_t>(part.size())};
  }

 private:
  std::string_view text_;
  std::size_t next_ = 0;
};

}  // namespace

std::optional<std::vector<glm::dvec3>> parse_vectors(SourceId source, Diagnostics& diagnostics) {
  if (!make_utf8_by_mark(source, diagnostics)) return std::nullopt;
  const std::string_view text = diagnostics.source_text(source);
  std::size_t count = 0;  // known before anything is allocated
  Lines counted(text);
  for (std::string_view line; counted.next(line);) {
    if (++count <= max_seeds) continue;
    diagnostics.report(Code::too_many_seeds, counted.span(line, source),
                       fmt::format("this is line {} of numbers, at most {} are allowed", count, max_seeds));
    return std::nullopt;
  }
  std::vector<glm::dvec3> result;
  result.reserve(count);
  std::size_t faults = 0;
  Lines lines(text);
  for (std::string_view line; faults < Diagnostics::cap && lines.next(line);) {
    const auto vector = parse_vector(line);
    if (const auto* value = std::get_if<glm::dvec3>(&vector)) {
      result.push_back(*value);
    } else {
      const auto& fault = std::get<NumberFault>(vector);
      diagnostics.report(fault.kind == NumberFault::Kind::not_finite ? Code::not_finite : Code::seed_line,
                         lines.span(line.substr(fault.begin, fault.end - fault.begin), source),
                         fmt::format("a line must be three numbers: {}", fault.message));
      ++faults;
    }
  }
  if (faults != 0) return std::nullopt;
  return result;
}

Span vector_span(SourceId source, std::size_t index, const Diagnostics& diagnostics) {
  const std::string_view text = diagnostics.source_text(source);
  Lines lines(text);
  std::string_view line;
  for (std::size_t i = 0; i <= index; ++i) {
    if (!lines.next(line)) return {source, 0, 0};
  }
  return lines.span(line, source);
}

}  // namespace dmvv::voml
