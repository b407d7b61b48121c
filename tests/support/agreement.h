// What every test of agreement shares: the forms of generated code, the moments looked at, and when an answer of a
// device agrees with the reference's.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "compiler/compile.h"
#include "compiler/reference/reference.h"

namespace dmvv::tests {

/// A form of generated code.
struct Setting {
  std::string name;
  compiler::CompileOptions options;
};

/// Elements that a storage texel buffer can have on every device.
inline constexpr std::uint32_t least_texel_buffer = 65536;

/// Each must answer like the reference (spec/accuracy.md).
inline std::vector<Setting> agreeing_settings() {
  std::vector<Setting> all{{"specialised", {}}, {"table", {}},  {"mixed", {}},
                           {"no passes", {}},   {"texels", {}}, {"mixed, texels", {}}};
  all[1].options.codegen = compiler::Codegen::table;
  all[2].options.inlined_line_budget = 200;
  for (const auto& pass : compiler::pass_names()) all[3].options.disabled_passes.emplace_back(pass.name);
  all[4].options.max_texel_buffer_elements = all[5].options.max_texel_buffer_elements = least_texel_buffer;
  all[5].options.inlined_line_budget = 200;
  return all;
}

/// What concerns distance grids only: each filter and each format, in both forms of code. The texture unit's own
/// weights are exact for 16-bit texels but not for 8 bits, on some devices.
inline std::vector<Setting> grid_settings() {
  using compiler::Codegen, compiler::Filter, compiler::TexelFormat;
  std::vector<Setting> all;
  const auto add = [&](std::string name, Filter filter, TexelFormat format, Codegen codegen) {
    compiler::CompileOptions options;
    options.filter = filter;
    options.atlas_format = format;
    options.codegen = codegen;
    all.push_back({std::move(name), std::move(options)});
  };
  add("hardware r16f, specialised", Filter::hardware, TexelFormat::r16f, Codegen::specialised);
  add("hardware snorm16, table", Filter::hardware, TexelFormat::snorm16, Codegen::table);
  add("shader r32f, specialised", Filter::shader, TexelFormat::r32f, Codegen::specialised);
  add("shader snorm8, table", Filter::shader, TexelFormat::snorm8, Codegen::table);
  add("tricubic snorm16, specialised", Filter::tricubic, TexelFormat::snorm16, Codegen::specialised);
  add("tricubic r32f, table", Filter::tricubic, TexelFormat::r32f, Codegen::table);
  return all;
}

/// How a reference of the module after run_passes reads the texels that such a program has.
inline compiler::Reference::Options reading_of(const Setting& setting) {
  compiler::Reference::Options reading;
  reading.filter = setting.options.filter;
  reading.format = setting.options.atlas_format;
  return reading;
}

/// A static scene is the same at all times; a moving one is looked at from its start to a day later.
inline std::vector<double> times_of(const compiler::Program& program) {
  if (program.time_slots.empty()) return {0.0};
  return {0.0, 16.7, 1234.5, 3600000.0, 86400000.0};
}

/// Where an answer is not the expected one: what was expected and what came; empty where they agree. Regions are
/// compared by number and by the names along the path, since passes may drop regions of a module.
struct Disagreement {
  std::string expected;
  std::string got;
};

inline std::optional<Disagreement> compare(const std::vector<compiler::RegionInfo>& expected_legend,
                                           const compiler::PointAnswer& expected,
                                           const std::vector<compiler::RegionInfo>& legend,
                                           const compiler::PointAnswer& got) {
  const auto text = [](const std::vector<compiler::RegionInfo>& regions, const compiler::PointAnswer& answer) {
    return "region " + std::to_string(answer.number) + " '" + compiler::format_path(regions, answer.path) + "' rgba " +
           std::to_string(answer.rgba.r) + " " + std::to_string(answer.rgba.g) + " " + std::to_string(answer.rgba.b) +
           " " + std::to_string(answer.rgba.a);
  };
  bool same = got.finished && got.number == expected.number &&
              compiler::format_path(legend, got.path) == compiler::format_path(expected_legend, expected.path);
  for (int c = 0; c < 4; ++c) same = same && std::abs(got.rgba[c] - expected.rgba[c]) < 1e-3;
  if (same) return std::nullopt;
  return Disagreement{text(expected_legend, expected), text(legend, got)};
}

}  // namespace dmvv::tests
