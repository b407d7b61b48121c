#include "authoring/table_text.h"

#include <algorithm>

#include "base/text.h"

namespace dmvv::authoring {

void TableText::report(Code code, std::string_view part, std::string message) {
  const auto begin = static_cast<std::uint32_t>(part.data() - text_.data());
  diagnostics_.report(code, {source_, begin, begin + static_cast<std::uint32_t>(part.size())}, std::move(message));
  failed_ = true;
}

std::size_t TableText::line_end(std::size_t from) const { return std::min(text_.find('\n', from), text_.size()); }

void TableText::skip_blanks() {
  const auto skipped = [&](char c) { return is_blank(c) && c != '\n' && (c != separator_ || separator_ == ' '); };
  while (at_ < text_.size() && skipped(text_[at_])) ++at_;
}

/// Whether a field ends before character i.
bool TableText::ends_field(std::size_t i) const {
  if (i == text_.size() || text_[i] == '\n') return true;
  if (comments_ == Comments::anywhere && text_[i] == '#') return true;
  return separator_ == ' ' ? is_blank(text_[i]) : text_[i] == separator_;
}

/// To the first line that holds something.
bool TableText::skip_to_row() {
  for (; at_ < text_.size(); at_ = line_end(at_) + 1) {
    const std::string_view line = trim(text_.substr(at_, line_end(at_) - at_));
    const bool comment =
        comments_ == Comments::anywhere ? line.starts_with('#') : line == "#" || line.starts_with("# ");
    if (!line.empty() && !comment) return true;
  }
  return false;
}

/// By what stands outside the quotes of the first row.
void TableText::find_separator() {
  std::string outside;
  bool quoted = false;
  for (std::size_t i = at_; i < text_.size() && (quoted || text_[i] != '\n'); ++i) {
    if (text_[i] == '"') quoted = !quoted;
    if (!quoted && comments_ == Comments::anywhere && text_[i] == '#') break;
    if (!quoted) outside += text_[i];
  }
  const std::string_view row = trim(outside);
  separator_ = blanks_ ? ' ' : ',';
  for (const char c : {'\t', ',', ';'}) {
    if (row.find(c) == row.npos) continue;
    separator_ = c;
    break;
  }
}

std::optional<Field> TableText::quoted_field() {
  const std::size_t begin = at_;
  std::size_t close = text_.find('"', begin + 1);
  bool doubled = false;
  for (; close != text_.npos && text_.substr(close + 1).starts_with('"'); close = text_.find('"', close + 2))
    doubled = true;
  if (close == text_.npos) {
    report(Code::table_syntax, text_.substr(begin, 1),
           "a quote that is not closed; within quotes, two of them are one");
    return std::nullopt;
  }
  Field field{text_.substr(begin + 1, close - begin - 1), text_.substr(begin, close + 1 - begin)};
  if (doubled) {
    std::string& plain = unquoted_.emplace_back();
    for (std::size_t i = 0; i < field.text.size(); i += field.text[i] == '"' ? 2 : 1) plain += field.text[i];
    field.text = plain;
  }
  at_ = close + 1;
  if (!ends_field(at_)) skip_blanks();
  if (ends_field(at_)) return field;
  report(Code::table_syntax, text_.substr(at_, 1), "text behind a closing quote; within quotes, two of them are one");
  return std::nullopt;
}

std::optional<Field> TableText::field() {
  if (at_ < text_.size() && text_[at_] == '"') return quoted_field();
  const std::size_t begin = at_;
  while (!ends_field(at_)) ++at_;
  const std::string_view text = trim(text_.substr(begin, at_ - begin));
  return Field{text, text};
}

std::optional<Row> TableText::next() {
  while (skip_to_row()) {
    if (separator_ == 0) find_separator();
    const std::size_t begin = at_;
    Row row;
    for (bool more = true; more;) {
      skip_blanks();
      if (separator_ == ' ' && !row.fields.empty() && ends_field(at_)) break;  // blanks behind the last field
      const auto next = field();
      if (!next) {
        at_ = text_.size();
        return std::nullopt;
      }
      row.fields.push_back(*next);
      more = at_ < text_.size() && text_[at_] != '\n' && !(comments_ == Comments::anywhere && text_[at_] == '#');
      if (more) ++at_;  // the separator
    }
    row.whole = trim(text_.substr(begin, at_ - begin));
    at_ = line_end(at_) + 1;
    const auto is_empty = [](const Field& f) { return f.text.empty(); };
    if (!std::ranges::all_of(row.fields, is_empty)) return row;
  }
  return std::nullopt;
}

}  // namespace dmvv::authoring
