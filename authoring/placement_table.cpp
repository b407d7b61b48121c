#include "authoring/placement_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <map>

#include "authoring/table_text.h"
#include "authoring/text_input.h"
#include "base/text.h"

namespace dmvv::authoring {
namespace {

constexpr std::size_t absent = static_cast<std::size_t>(-1);

/// The columns that have a meaning. Matrices are named row, column; those counted from 1 are renamed before.
enum Column : std::size_t { x, y, z, qw, qx, qy, qz, rx, ry, rz, m00, scale = m00 + 9, sx, sy, sz, kind, column_count };
constexpr std::array<std::string_view, column_count> column_names{
    "x",   "y",   "z",   "qw",  "qx",  "qy",  "qz",  "rx",    "ry", "rz", "m00", "m01",
    "m02", "m10", "m11", "m12", "m20", "m21", "m22", "scale", "sx", "sy", "sz",  "kind"};

/// What else columns are called, unless the usual name is there too.
constexpr std::array<std::array<std::string_view, 2>, 5> other_names{
    {{"t1", "x"}, {"t2", "y"}, {"t3", "z"}, {"radius", "scale"}, {"entity", "kind"}}};

using Columns = std::array<std::size_t, column_count>;

/// Ends the reading: what follows cannot be trusted.
struct Refusal {};

class TableReader {
 public:
  TableReader(SourceId source, const TableOptions& options, Diagnostics& diagnostics)
      : rows_(source, Comments::anywhere, true, diagnostics), options_(options) {}

  void read() {
    while (const auto row = rows_.next()) width_ == 0 ? read_first(*row) : read_row(*row);
    if (count_ == 0 && !rows_.failed())
      rows_.report(Code::table_without_rows, rows_.text().substr(0, 0), "the table holds no row");
  }

  PlacementTable table;

 private:
  [[noreturn]] void refuse(Code code, std::string_view part, std::string message) {
    rows_.report(code, part, std::move(message));
    throw Refusal{};
  }

  static bool is_number(const Field& field) { return std::holds_alternative<double>(parse_number(field.text)); }

  void read_first(const Row& row) {
    const std::vector<Field>& fields = row.fields;
    const bool header = std::ranges::none_of(fields, is_number);
    std::vector<std::string> names;
    if (!options_.columns.empty()) {
      for (std::size_t at = 0; at <= options_.columns.size();) {
        const std::size_t end = std::min(options_.columns.find(',', at), options_.columns.size());
        names.push_back(std::string(trim(options_.columns.substr(at, end - at))));
        at = end + 1;
      }
      if (names.size() != fields.size())
        refuse(Code::table_columns, row.whole,
               fmt::format("the row has {} fields, --columns names {}", fields.size(), names.size()));
    } else if (header) {
      for (const Field& field : fields) names.emplace_back(field.text);
    } else if (fields.size() == 3 || fields.size() == 4) {
      names = {"x", "y", "z"};
      if (fields.size() == 4) names.push_back(is_number(fields[3]) ? "scale" : "kind");
    } else {
      refuse(Code::table_columns, row.whole,
             fmt::format("{} fields without names; give a first row of names, or --columns", fields.size()));
    }
    width_ = fields.size();
    name_columns(names, row, header && options_.columns.empty());
    if (!header) read_row(row);
  }

  /// `in_file`: the names are the fields of this row.
  void name_columns(std::vector<std::string> names, const Row& row, bool in_file) {
    const std::string_view line = row.whole;
    for (std::string& name : names) name = lower_case(name);
    const auto named = [&](std::string_view name) { return std::ranges::find(names, name) != names.end(); };
    for (const auto& [other, usual] : other_names)
      if (!named(usual)) std::ranges::replace(names, std::string(other), std::string(usual));
    if (named("m33") && !named("m00")) {
      for (std::string& name : names) {
        if (name.size() == 3 && name[0] == 'm' && name[1] >= '1' && name[1] <= '3' && name[2] >= '1' && name[2] <= '3')
          name = {'m', static_cast<char>(name[1] - 1), static_cast<char>(name[2] - 1)};
      }
    }
    columns_.fill(absent);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto found = std::ranges::find(column_names, names[i]);
      if (found == column_names.end()) continue;
      std::size_t& column = columns_[static_cast<std::size_t>(found - column_names.begin())];
      if (column != absent)
        refuse(Code::table_columns, in_file ? row.fields[i].whole : line,
               fmt::format("the column '{}' stands twice", names[i]));
      column = i;
    }
    const bool matrix = group(m00, 9, line), quaternion = group(qw, 4, line), three_scales = group(sx, 3, line);
    const bool euler = columns_[rx] != absent || columns_[ry] != absent || columns_[rz] != absent;
    if (!group(x, 3, line))
      refuse(Code::table_columns, line,
             "the table has no columns x, y and z; name them in a first row, or by --columns");
    if (matrix + quaternion + euler > 1)
      refuse(Code::table_columns, line, "the table has rotations of two forms; leave one out by --columns");
    if (three_scales && columns_[scale] != absent)
      refuse(Code::table_columns, line, "the table has both 'scale' and 'sx'; leave one out by --columns");
    form_ = matrix ? m00 : quaternion ? qw : euler ? rx : column_count;
    table.has_rotations = form_ != column_count;
    table.has_scales = three_scales || columns_[scale] != absent;
  }

  /// Whether columns first, first + 1, ... are there; some but not all of them is an error.
  bool group(std::size_t first, std::size_t count, std::string_view line) {
    const auto there = [&](std::size_t i) { return columns_[i] != absent; };
    std::size_t missing = absent, found = absent;
    for (std::size_t i = first; i < first + count; ++i) (there(i) ? found : missing) = i;
    if (found != absent && missing != absent) {
      refuse(
          Code::table_columns, line,
          fmt::format("the table has a column '{}' but none named '{}'", column_names[found], column_names[missing]));
    }
    return found != absent;
  }

  void read_row(const Row& row) {
    const std::vector<Field>& fields = row.fields;
    ++count_;
    if (fields.size() != width_) {
      return rows_.report(Code::table_syntax, row.whole,
                          fmt::format("the row has {} fields, the first one {}", fields.size(), width_));
    }
    bool good = true;
    const auto value = [&](std::size_t column) {
      if (columns_[column] == absent) return 0.0;  // an angle
      const Field& field = fields[columns_[column]];
      const auto number = parse_number(field.text);
      if (const double* const v = std::get_if<double>(&number)) return *v;
      rows_.report(Code::table_syntax, field.whole.empty() ? row.whole : field.whole,
                   fmt::format("'{}' is {}, not a finite number{}", column_names[column], in_quotes(field.text),
                               decimal_point_hint(field.text)));
      good = false;
      return 0.0;
    };
    Placement placement;
    placement.position = {value(x), value(y), value(z)};
    std::optional<Rotation> rotation = Rotation{glm::dmat3(1.0), 0.0};
    if (form_ == rx) rotation->matrix = euler_rotation({value(rx), value(ry), value(rz)});
    if (form_ == qw) rotation = quaternion_rotation(value(qw), value(qx), value(qy), value(qz));
    if (form_ == m00) {
      glm::dmat3 m;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[j][i] = value(m00 + static_cast<std::size_t>(3 * i + j));
      rotation = nearest_rotation(m);
    }
    if (good && !rotation) {
      good = false;
      rows_.report(Code::not_a_rotation, fields[columns_[form_]].whole,
                   form_ == m00 ? "the matrix that begins here is too far from orthogonal, or mirrors"
                                : "the quaternion of this row is too far from unit length");
    }
    if (columns_[scale] != absent) placement.scale = glm::dvec3(value(scale));
    if (columns_[sx] != absent) placement.scale = {value(sx), value(sy), value(sz)};
    for (int axis = 0; good && axis < 3; ++axis) {
      if (placement.scale[axis] > 0.0 && usable_scale(placement.scale[axis])) continue;
      good = false;
      const std::size_t column = columns_[scale] != absent ? scale : sx + static_cast<std::size_t>(axis);
      rows_.report(Code::table_syntax, fields[columns_[column]].whole,
                   fmt::format("'{}' is {}, it must be greater than zero", column_names[column],
                               in_quotes(fields[columns_[column]].text)));
    }
    if (!good) return;
    placement.rotation = rotation->matrix;
    table.repaired += rotation->fault > exact_rotation;
    table.worst = std::max(table.worst, rotation->fault);
    const std::string name = columns_[kind] == absent ? "kind" : std::string(fields[columns_[kind]].text);
    const auto [place, is_new] = kinds_.try_emplace(name, table.kinds.size());
    if (is_new) table.kinds.push_back({name, {}});
    table.kinds[place->second].placements.push_back(placement);
  }

  TableText rows_;
  const TableOptions& options_;
  std::size_t width_ = 0, count_ = 0;
  Columns columns_{};
  std::size_t form_ = column_count;  ///< the first column of the rotations
  std::map<std::string, std::size_t> kinds_;
};

}  // namespace

std::optional<PlacementTable> parse_placement_table(const std::string& path, std::string_view bytes,
                                                    const TableOptions& options, Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  const auto source = add_text(path, bytes, Code::table_syntax, diagnostics);
  if (!source) return std::nullopt;
  TableReader reader(*source, options, diagnostics);
  try {
    reader.read();
  } catch (const Refusal&) {
  }
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  return std::move(reader.table);
}

double default_scale(const PlacementTable& table) {
  glm::dvec3 lo = table.kinds.front().placements.front().position, hi = lo;
  std::size_t count = 0;
  for (const PlacedKind& kind : table.kinds) {
    count += kind.placements.size();
    for (const Placement& placement : kind.placements) {
      lo = glm::min(lo, placement.position);
      hi = glm::max(hi, placement.position);
    }
  }
  glm::dvec3 side = hi - lo;
  const double longest = std::max({side.x, side.y, side.z});
  if (longest == 0.0) return 1.0;
  for (int axis = 0; axis < 3; ++axis)
    if (side[axis] < 0.01 * longest) side[axis] = longest;
  return 0.5 * std::cbrt(side.x * side.y * side.z / static_cast<double>(count));
}

}  // namespace dmvv::authoring
