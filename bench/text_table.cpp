#include "bench/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dmvv::bench {

TextTable::TextTable(std::vector<std::string> names, std::vector<std::string> units)
    : head_{std::move(names), std::move(units)} {}

void TextTable::add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

std::string TextTable::text() const {
  std::vector<std::size_t> widths(head_.front().size(), 0);
  for (const auto* part : {&head_, &rows_}) {
    for (const auto& row : *part) {
      for (std::size_t i = 0; i < std::min(row.size(), widths.size()); ++i)
        widths[i] = std::max(widths[i], row[i].size());
    }
  }
  std::string text;
  for (const auto* part : {&head_, &rows_}) {
    for (const auto& row : *part) {
      if (std::ranges::all_of(row, [](const std::string& cell) { return cell.empty(); })) continue;
      std::string line = "  ";
      for (std::size_t i = 0; i < std::min(row.size(), widths.size()); ++i) {
        line += i == 0 ? fmt::format("{:<{}}", row[i], widths[i]) : fmt::format("  {:>{}}", row[i], widths[i]);
      }
      line.erase(line.find_last_not_of(' ') + 1);
      text += line + '\n';
    }
  }
  return text;
}

std::string number(double value) {
  if (std::isnan(value)) return "-";
  if (value == 0.0) return "0";
  const double magnitude = std::abs(value);
  if (magnitude < 1e-3 || magnitude >= 999999.5) return fmt::format("{:.1e}", value);
  const int digits = std::clamp(2 - static_cast<int>(std::floor(std::log10(magnitude))), 0, 5);
  return fmt::format("{:.{}f}", value, digits);
}

}  // namespace dmvv::bench
