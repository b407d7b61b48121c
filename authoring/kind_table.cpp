#include "authoring/kind_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "authoring/table_text.h"
#include "authoring/text_input.h"
#include "base/text.h"

namespace dmvv::authoring {
namespace {

/// "0.902 0.502 0.102" of "#e6801a"; nothing if it is none.
std::optional<std::string> parse_rgb(std::string_view text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  int channels[3] = {0, 0, 0};
  for (std::size_t i = 1; i < 7; ++i) {
    const auto digit = std::string_view("0123456789abcdef").find(lower_case(text.substr(i, 1)));
    if (digit == std::string_view::npos) return std::nullopt;
    int& channel = channels[(i - 1) / 2];
    channel = 16 * channel + static_cast<int>(digit);
  }
  return fmt::format("{:.4f} {:.4f} {:.4f}", channels[0] / 255.0, channels[1] / 255.0, channels[2] / 255.0);
}

constexpr std::size_t absent = static_cast<std::size_t>(-1);

class Reader {
 public:
  Reader(SourceId source, Diagnostics& diagnostics) : rows_(source, Comments::lines, false, diagnostics) {}

  KindTable read() {
    while (const auto row = rows_.next()) {
      if (width_ != 0)
        read_row(*row);
      else if (!read_names(*row))
        return {};
    }
    if (width_ == 0 && !rows_.failed())
      rows_.report(Code::table_columns, rows_.text().substr(0, 0), "the table of kinds is empty");
    return std::move(table_);
  }

 private:
  bool read_names(const Row& row) {
    const std::vector<Field>& fields = row.fields;
    width_ = fields.size();
    for (std::size_t i = 0; i < width_; ++i) {
      const std::string name = lower_case(fields[i].text);
      std::size_t* const column = name == "kind" || name == "entity" ? &kind_
                                  : name == "name"                   ? &name_
                                  : name == "rgb"                    ? &rgb_
                                  : name == "radius"                 ? &radius_
                                                                     : nullptr;
      if (!column) continue;
      if (*column != absent) {
        rows_.report(Code::table_columns, fields[i].whole, fmt::format("the column '{}' stands twice", name));
        return false;
      }
      *column = i;
    }
    if (kind_ != absent && (name_ != absent || rgb_ != absent || radius_ != absent)) return true;
    rows_.report(Code::table_columns, row.whole,
                 "the table of kinds needs a column 'kind', and 'name', 'rgb' or 'radius'");
    return false;
  }

  void read_row(const Row& row) {
    const std::vector<Field>& fields = row.fields;
    if (fields.size() != width_) {
      return rows_.report(Code::table_syntax, row.whole,
                          fmt::format("the row has {} fields, the first one {}", fields.size(), width_));
    }
    const auto fault = [&](std::size_t column, std::string_view message) {
      rows_.report(Code::table_syntax, fields[column].whole,
                   fmt::format(fmt::runtime(message), in_quotes(fields[column].text)));
    };
    KindLook look;
    if (name_ != absent) look.name = fields[name_].text;
    if (rgb_ != absent && !fields[rgb_].text.empty()) {
      const auto rgb = parse_rgb(fields[rgb_].text);
      if (!rgb) return fault(rgb_, "{} is no colour; write #e6801a");
      look.rgb = *rgb;
    }
    if (radius_ != absent && !fields[radius_].text.empty()) {
      const auto radius = parse_number(fields[radius_].text);
      const double* const value = std::get_if<double>(&radius);
      if (!value || !(*value > 0.0))
        return fault(radius_, "{} is no radius" + decimal_point_hint(fields[radius_].text));
      look.radius = *value;
    }
    if (!table_.try_emplace(std::string(fields[kind_].text), std::move(look)).second)
      fault(kind_, "the kind {} stands twice");
  }

  TableText rows_;
  std::size_t width_ = 0, kind_ = absent, name_ = absent, rgb_ = absent, radius_ = absent;
  KindTable table_;
};

}  // namespace

std::optional<KindTable> parse_kind_table(const std::string& path, std::string_view bytes, Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  const auto source = add_text(path, bytes, Code::table_syntax, diagnostics);
  if (!source) return std::nullopt;
  KindTable table = Reader(*source, diagnostics).read();
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  return table;
}

}  // namespace dmvv::authoring
