#include "authoring/kind_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "voml/limits.h"
#include "voml/text.h"

namespace dmvv::authoring {
namespace {

/// "0.902 0.502 0.102" of "#e6801a"; nothing if it is none.
std::optional<std::string> parse_rgb(std::string_view text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  int channels[3] = {0, 0, 0};
  for (std::size_t i = 1; i < 7; ++i) {
    const auto digit = std::string_view("0123456789abcdef").find(voml::lower_case(text.substr(i, 1)));
    if (digit == std::string_view::npos) return std::nullopt;
    int& channel = channels[(i - 1) / 2];
    channel = 16 * channel + static_cast<int>(digit);
  }
  return fmt::format("{:.4f} {:.4f} {:.4f}", channels[0] / 255.0, channels[1] / 255.0, channels[2] / 255.0);
}

std::vector<std::string_view> fields_of(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    fields.push_back(voml::trim(line.substr(at, end - at)));
    at = end + 1;
  }
  return fields;
}

constexpr std::size_t absent = static_cast<std::size_t>(-1);

class Reader {
 public:
  Reader(SourceId source, Diagnostics& diagnostics)
      : source_(source), text_(diagnostics.source_text(source)), diagnostics_(diagnostics) {}

  KindTable read() {
    for (std::size_t begin = text_.starts_with("\xef\xbb\xbf") ? 3 : 0; begin < text_.size();) {
      const std::size_t end = std::min(text_.find('\n', begin), text_.size());
      const std::string_view line = text_.substr(begin, end - begin);
      begin = end + 1;
      const std::string_view inner = voml::trim(line);
      if (inner.empty() || inner == "#" || inner.starts_with("# ")) continue;
      if (width_ == 0) {
        if (!read_names(line)) return {};
      } else {
        read_row(line);
      }
    }
    if (width_ == 0) report(Code::table_columns, text_.substr(0, 0), "the table of kinds is empty");
    return std::move(table_);
  }

 private:
  void report(Code code, std::string_view part, std::string message) {
    const auto begin = static_cast<std::uint32_t>(part.data() - text_.data());
    diagnostics_.report(code, {source_, begin, begin + static_cast<std::uint32_t>(part.size())}, std::move(message));
  }

  bool read_names(std::string_view line) {
    separator_ = line.find('\t') != line.npos ? '\t' : ',';
    const std::vector<std::string_view> fields = fields_of(line, separator_);
    width_ = fields.size();
    for (std::size_t i = 0; i < width_; ++i) {
      const std::string name = voml::lower_case(fields[i]);
      std::size_t* const column = name == "kind" || name == "entity" ? &kind_
                                  : name == "name"                   ? &name_
                                  : name == "rgb"                    ? &rgb_
                                  : name == "radius"                 ? &radius_
                                                                     : nullptr;
      if (!column) continue;
      if (*column != absent) {
        report(Code::table_columns, fields[i], fmt::format("the column '{}' stands twice", name));
        return false;
      }
      *column = i;
    }
    if (kind_ != absent && (name_ != absent || rgb_ != absent || radius_ != absent)) return true;
    report(Code::table_columns, line, "the table of kinds needs a column 'kind', and 'name', 'rgb' or 'radius'");
    return false;
  }

  void read_row(std::string_view line) {
    const std::vector<std::string_view> fields = fields_of(line, separator_);
    if (fields.size() != width_) {
      return report(Code::table_syntax, line,
                    fmt::format("the row has {} fields, the first one {}", fields.size(), width_));
    }
    KindLook look;
    if (name_ != absent) look.name = fields[name_];
    if (rgb_ != absent && !fields[rgb_].empty()) {
      const auto rgb = parse_rgb(fields[rgb_]);
      if (!rgb)
        return report(Code::table_syntax, fields[rgb_],
                      fmt::format("{} is no colour; write #e6801a", voml::in_quotes(fields[rgb_])));
      look.rgb = *rgb;
    }
    if (radius_ != absent && !fields[radius_].empty()) {
      const auto radius = voml::parse_number(fields[radius_]);
      const double* const value = std::get_if<double>(&radius);
      if (!value || !(*value > 0.0))
        return report(Code::table_syntax, fields[radius_],
                      fmt::format("{} is no radius", voml::in_quotes(fields[radius_])));
      look.radius = *value;
    }
    if (!table_.try_emplace(std::string(fields[kind_]), std::move(look)).second)
      report(Code::table_syntax, fields[kind_],
             fmt::format("the kind {} stands twice", voml::in_quotes(fields[kind_])));
  }

  SourceId source_;
  std::string_view text_;
  Diagnostics& diagnostics_;
  char separator_ = ',';
  std::size_t width_ = 0, kind_ = absent, name_ = absent, rgb_ = absent, radius_ = absent;
  KindTable table_;
};

}  // namespace

std::optional<KindTable> parse_kind_table(const std::string& path, std::string_view bytes, Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  const bool too_long = bytes.size() > voml::max_file_bytes;
  const SourceId source = diagnostics.add_source(path, too_long ? "" : std::string(bytes));
  if (too_long) {
    diagnostics.report(Code::table_syntax, {source, 0, 0}, "the file is 4 GiB or longer");
    return std::nullopt;
  }
  KindTable table = Reader(source, diagnostics).read();
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  return table;
}

}  // namespace dmvv::authoring
