#include "base/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <numeric>

#include "base/encoding.h"

namespace dmvv {

// ---- the table ----

const std::vector<CodeInfo>& all_codes() {
  constexpr Severity warning = Severity::warning;
  constexpr Severity error = Severity::error;
  static const std::vector<CodeInfo> codes = {
#define DMVV_CODE(number, severity, name, explanation) CodeInfo{Code::name, severity, number, #name, explanation},
#include "base/diagnostic_codes.def"
#undef DMVV_CODE
  };
  static_cast<void>(warning);  // the table may hold none of them
  static_cast<void>(error);
  return codes;
}

const CodeInfo& info(Code code) { return all_codes()[static_cast<std::size_t>(code)]; }

// ---- collecting ----

SourceId Diagnostics::add_source(std::string name, std::string text) {
  sources_.push_back({std::move(name), std::move(text)});
  return SourceId{static_cast<std::uint32_t>(sources_.size() - 1)};
}

void Diagnostics::report(Code code, Span span, std::string message, std::vector<Note> notes) {
  const bool known = span.source.valid() && std::any_of(diagnostics_.begin(), diagnostics_.end(), [&](const auto& d) {
                       return d.code == code && d.span == span;
                     });
  if (known) return;
  const Severity severity = strict_ ? Severity::error : info(code).severity;
  ++(severity == Severity::error ? errors_ : warnings_);
  if (diagnostics_.size() < cap) {
    diagnostics_.push_back({severity, code, span, std::move(message), std::move(notes)});
  }
}

// ---- places in a text ----
namespace {

constexpr std::string_view utf8_bom = "\xef\xbb\xbf";
constexpr std::size_t shown_before = 80;   // code points of a long line shown before the caret
constexpr std::size_t shown_in_all = 160;  // and in all

bool continues_code_point(char c) { return (static_cast<unsigned char>(c) & 0xc0u) == 0x80u; }

std::size_t text_begin(std::string_view text) { return text.starts_with(utf8_bom) ? utf8_bom.size() : 0; }

/// The line that holds `offset`: bytes [begin, end) without its line end (LF, CR LF or CR), and its number from 1.
struct Line {
  std::size_t begin;
  std::size_t end;
  std::uint32_t number;
};

Line line_at(std::string_view text, std::size_t offset) {
  Line line{text_begin(text), text.size(), 1};
  for (std::size_t i = line.begin; i < std::min(offset, text.size()); ++i) {
    const bool cr_of_crlf = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
    if (cr_of_crlf || (text[i] != '\n' && text[i] != '\r')) continue;
    line.begin = i + 1;
    ++line.number;
  }
  line.end = std::min(text.find_first_of("\r\n", line.begin), text.size());
  return line;
}

std::size_t count_code_points(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return !continues_code_point(c); }));
}

/// Terminals must not be driven by the text of a file: control characters but tabs, and what is not UTF-8, become '?'.
std::string printable(std::string_view text) {
  std::string result(text);
  for (auto fault = first_not_utf8(result); fault;) {
    result[*fault] = '?';
    const auto next = first_not_utf8(std::string_view(result).substr(*fault));
    fault = next ? std::optional(*fault + *next) : std::nullopt;
  }
  for (char& c : result) {
    if ((static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f) c = '?';
  }
  return result;
}

/// The source line and a caret under [begin, end); long lines are cut around the caret.
std::string snippet(std::string_view text, std::size_t begin, std::size_t end) {
  const Line line = line_at(text, begin);
  begin = std::clamp(begin, line.begin, line.end);
  end = std::clamp(end, begin, line.end);

  std::size_t from = begin;
  for (std::size_t n = 0; from > line.begin && n < shown_before; --from) n += !continues_code_point(text[from - 1]);
  while (from > line.begin && continues_code_point(text[from])) --from;
  std::size_t to = from;
  for (std::size_t n = 0; to < line.end && n < shown_in_all; ++to) n += !continues_code_point(text[to]);
  while (to < line.end && continues_code_point(text[to])) ++to;
  end = std::clamp(end, begin, std::max(begin, to));

  const std::string_view head = from > line.begin ? "..." : "";
  const std::string_view tail = to < line.end ? "..." : "";
  std::string indent(head.size(), ' ');
  for (std::size_t i = from; i < begin; ++i) {
    if (!continues_code_point(text[i]))
      indent += text[i] == '\t' ? '\t' : ' ';  // tabs stay, so the caret keeps its place
  }
  const std::size_t width = std::max<std::size_t>(count_code_points(text.substr(begin, end - begin)), 1);
  return fmt::format("{:>5} | {}{}{}\n      | {}^{}\n", line.number, head, printable(text.substr(from, to - from)),
                     tail, indent, std::string(width - 1, '~'));
}

std::string plural(std::size_t n, std::string_view noun) { return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s"); }

}  // namespace

LineColumn Diagnostics::locate(SourceId source, std::uint32_t offset) const {
  const std::string_view text = source_text(source);
  const Line line = line_at(text, offset);
  const std::size_t end = std::clamp<std::size_t>(offset, line.begin, text.size());
  const std::size_t before = count_code_points(text.substr(line.begin, end - line.begin));
  return {line.number, static_cast<std::uint32_t>(before + 1)};
}

// ---- rendering ----

std::string Diagnostics::render() const {
  if (diagnostics_.empty()) return {};

  std::string result;
  const auto print = [&](const Span& span, std::string_view kind, const std::string& message) {
    const bool placed = span.source.valid() && !source_text(span.source).empty();
    if (span.source.valid()) result += printable(source_name(span.source)) + ":";
    if (placed) {
      const LineColumn at = locate(span.source, span.begin);
      result += fmt::format("{}:{}:", at.line, at.column);
    }
    result += fmt::format("{}{}: {}\n", span.source.valid() ? " " : "", kind, printable(message));
    if (placed) result += snippet(source_text(span.source), span.begin, span.end);
  };

  std::vector<std::size_t> order(diagnostics_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place = [&](std::size_t i) {
    const Span& span = diagnostics_[i].span;
    return std::pair(span.source.valid() ? std::int64_t{span.source.index} : -1, span.begin);  // placeless ones first
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });

  for (const std::size_t i : order) {
    const Diagnostic& d = diagnostics_[i];
    const std::string_view word = d.severity == Severity::error ? "error" : "warning";
    print(d.span, fmt::format("{}[{}]", word, info(d.code).number), d.message);
    for (const Note& note : d.notes) print(note.span, "note", note.message);
  }

  std::string counts;
  if (errors_ != 0) counts = plural(errors_, "error");
  if (warnings_ != 0) counts += (counts.empty() ? "" : ", ") + plural(warnings_, "warning");
  if (errors_ + warnings_ > cap) counts += fmt::format("; the first {} are shown", cap);
  return result + counts + "\n";
}

// ---- suggestions ----
namespace {

/// Optimal string alignment distance, or `limit + 1` if it is larger than `limit`.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > limit) return limit + 1;
  std::vector<std::size_t> two_back(b.size() + 1), previous(b.size() + 1), current(b.size() + 1);
  std::iota(previous.begin(), previous.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = previous[j - 1] + (a[i - 1] != b[j - 1]);
      current[j] = std::min({previous[j] + 1, current[j - 1] + 1, substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        current[j] = std::min(current[j], two_back[j - 2] + 1);
      }
    }
    if (*std::min_element(current.begin(), current.end()) > limit) return limit + 1;
    std::swap(two_back, previous);
    std::swap(previous, current);
  }
  return previous[b.size()];
}

}  // namespace

std::optional<std::string_view> nearest_name(std::string_view word, const std::vector<std::string_view>& candidates) {
  constexpr std::size_t longest = 256;  // nobody mistypes a longer name; the distance is quadratic in it
  if (word.size() > longest) return std::nullopt;
  std::optional<std::string_view> best;
  std::size_t best_distance = longest;
  for (const std::string_view candidate : candidates) {
    if (candidate.size() > longest) continue;
    const std::size_t near_enough = std::max<std::size_t>(std::max(word.size(), candidate.size()) / 3, 1);
    const std::size_t limit = std::min(near_enough, best_distance - 1);
    const std::size_t distance = edit_distance(word, candidate, limit);
    if (distance > limit) continue;
    if (distance == 0) return candidate;
    best = candidate;
    best_distance = distance;
  }
  return best;
}

}  // namespace dmvv
