// Aligned columns of text.
#pragma once

#include <string>
#include <vector>

namespace dmvv::bench {

/// The first column is aligned left, the others right. Rows may be shorter than the header.
class TextTable {
 public:
  /// `units` is printed below the names; as many as there are names.
  TextTable(std::vector<std::string> names, std::vector<std::string> units);
  void add(std::vector<std::string> cells);
  bool empty() const { return rows_.empty(); }
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_, head_;
};

/// Three significant digits, never more than 7 characters: "0.0123", "1.23", "12.3", "1230", "1.2e-06"; "-" for NaN.
std::string number(double value);

}  // namespace dmvv::bench
