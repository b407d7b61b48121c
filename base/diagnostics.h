// The author's mistakes: collected, never thrown; each with a code, a place, a sentence and a way out.
//
//   orange.voml:30:34: error[E0103]: unknown region 'R.INTER'; did you mean 'R.INNER'?
//      30 |         <POSITIVE><REGION name="R.INTER"/></POSITIVE>
//         |                                 ^~~~~~~
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dmvv {

enum class Severity : std::uint8_t { warning, error };

/// Every code there is; the table with numbers, severities and explanations is diagnostic_codes.def.
enum class Code : std::uint16_t {
#define DMVV_CODE(number, severity, name, explanation) name,
#include "base/diagnostic_codes.def"
#undef DMVV_CODE
};

/// What the table says of one code.
struct CodeInfo {
  Code code;
  Severity severity;
  std::string_view number;       ///< "E0103", "W0201"
  std::string_view name;         ///< "unknown_name"
  std::string_view explanation;  ///< one sentence for spec/diagnostics.md
};

const CodeInfo& info(Code code);
const std::vector<CodeInfo>& all_codes();

/// Index of a text or binary file that was read; see Diagnostics::add_source.
struct SourceId {
  std::uint32_t index = 0xffffffffu;
  bool valid() const { return index != 0xffffffffu; }
  friend bool operator==(SourceId, SourceId) = default;
};

/// A piece of a source: bytes [begin, end). begin == end marks a point; an invalid source marks no place at all.
struct Span {
  SourceId source;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  friend bool operator==(const Span&, const Span&) = default;
};

struct Note {
  Span span;  ///< may be nowhere
  std::string message;
};

struct Diagnostic {
  Severity severity;
  Code code;
  Span span;
  std::string message;  ///< one sentence, lower case, no full stop; names both numbers when two disagree
  std::vector<Note> notes;
};

/// 1-based; columns count UTF-8 code points.
struct LineColumn {
  std::uint32_t line;
  std::uint32_t column;
};

/// Collects diagnostics of all stages, and the source texts they point into.
///
/// Keeps at most `cap` diagnostics; the ones beyond are counted only. Reporting the same code at the same span
/// twice keeps the first. With `strict`, warnings are recorded as errors.
class Diagnostics {
 public:
  static constexpr std::size_t cap = 100;

  explicit Diagnostics(bool strict = false) : strict_(strict) {}

  /// Registers a file so that spans can point into it. `text` may be empty for a binary file: then only the name is
  /// printed. Cost: a copy of the text.
  SourceId add_source(std::string name, std::string text);

  /// Puts a converted text in the place of a source that nothing has been reported of yet.
  void replace_source_text(SourceId source, std::string text) { sources_[source.index].text = std::move(text); }

  void report(Code code, Span span, std::string message, std::vector<Note> notes = {});

  bool has_errors() const { return errors_ != 0; }
  std::size_t error_count() const { return errors_; }
  std::size_t warning_count() const { return warnings_; }
  const std::vector<Diagnostic>& all() const { return diagnostics_; }

  const std::string& source_name(SourceId source) const { return sources_[source.index].name; }
  const std::string& source_text(SourceId source) const { return sources_[source.index].text; }
  LineColumn locate(SourceId source, std::uint32_t offset) const;

  /// All diagnostics as text, in the order of their places (sources in the order they were opened), each with its
  /// source line and caret, and a last line that counts them. Empty when there is nothing to say.
  std::string render() const;

 private:
  struct Source {
    std::string name;
    std::string text;
  };
  bool strict_;
  std::vector<Source> sources_;
  std::vector<Diagnostic> diagnostics_;
  std::size_t errors_ = 0;
  std::size_t warnings_ = 0;
};

/// The candidate nearest to `word` by edit distance (transpositions count one), if it is near enough to be a typo
/// (distance at most a third of the longer word, at least 1); ties go to the first.
std::optional<std::string_view> nearest_name(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace dmvv
