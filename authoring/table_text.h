// Private to authoring: the rows and fields of tables as text, as RFC 4180 has them.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"

namespace dmvv::authoring {

/// A field without the blanks and quotes round it, two quotes within quotes being one.
struct Field {
  std::string_view text;
  std::string_view whole;  ///< as it stands in the file
};

struct Row {
  std::vector<Field> fields;
  std::string_view whole;
};

enum class Comments {
  anywhere,  ///< from a '#' outside quotes to the line's end
  lines,     ///< lines that begin with '#' and a blank, or hold nothing else
};

/// Walks the rows of a table. Fields are separated by tabs, commas, semicolons or blanks: whichever of these the first
/// row has outside quotes, in this order; blanks only where `blanks` says so. A field that begins with a quote ends
/// with one and may hold separators and line ends. Lines that are empty, and rows of nothing but empty fields, are
/// passed over.
///
/// Errors: E0564 a quote that is not closed, or text behind a closing one; then the reading ends.
/// Source: RFC 4180; fields of text and numbers separated otherwise follow the same rules.
class TableText {
 public:
  /// The text must live as long as this and its fields do.
  TableText(SourceId source, Comments comments, bool blanks, Diagnostics& diagnostics)
      : source_(source),
        text_(diagnostics.source_text(source)),
        comments_(comments),
        blanks_(blanks),
        diagnostics_(diagnostics) {}

  /// The next row; nothing at the end or behind an error.
  std::optional<Row> next();

  /// `part` is a view into the text.
  void report(Code code, std::string_view part, std::string message);
  std::string_view text() const { return text_; }
  bool failed() const { return failed_; }  ///< whether anything has been reported

 private:
  bool skip_to_row();
  void find_separator();
  bool ends_field(std::size_t i) const;
  std::optional<Field> field();
  std::optional<Field> quoted_field();
  void skip_blanks();
  std::size_t line_end(std::size_t from) const;

  SourceId source_;
  std::string_view text_;
  Comments comments_;
  bool blanks_;
  Diagnostics& diagnostics_;
  char separator_ = 0;
  std::size_t at_ = 0;
  bool failed_ = false;
  std::deque<std::string> unquoted_;  ///< fields that held doubled quotes
};

}  // namespace dmvv::authoring
