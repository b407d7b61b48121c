#include <fmt/format.h>

#include <optional>

#include "compiler/glsl/generate_glsl.h"
#include "compiler/glsl/kernel.h"
#include "compiler/grids/storage.h"
#include "compiler/layout/record_access.h"
#include "compiler/plan/codegen.h"
#include "compiler/shader_text.h"
#include "shaders/records.h"

namespace dmvv::compiler {

namespace {

std::string_view format_name(BufferForm form) {
  if (form == BufferForm::r32ui) return "r32ui";
  return form == BufferForm::rg32ui ? "rg32ui" : "rgba32ui";
}

std::string bindings(const Uses& uses, RecordAccess access) {
  std::string text;
  const auto sampler = [&](const char* slot, const char* name) {
    text += fmt::format("layout(set = 0, binding = {}) uniform sampler3D {};\n", slot, name);
  };
  const auto buffer = [&](const char* slot, const char* block, const char* type, const char* name) {
    text += fmt::format("layout(set = 0, binding = {}, std430) readonly buffer {} {{ {} {}[]; }};\n", slot, block, type,
                        name);
  };
  const auto found = [&](std::uint32_t binding, const char* slot, const char* block, const char* type,
                         const char* name) {
    const BufferForm form = form_of(binding, access);
    if (form == BufferForm::records) return buffer(slot, block, type, name);
    text += fmt::format("layout(set = 0, binding = {}, {}) readonly uniform uimageBuffer {};\n", slot,
                        format_name(form), name);
  };
  if (uses.grid_atlas) sampler("DMVV_BIND_GRID_ATLAS", "grid_atlas");
  if (uses.bitmap_atlas) sampler("DMVV_BIND_BITMAP_ATLAS", "bitmap_atlas");
  if (uses.placements)
    found(DMVV_BIND_PLACEMENTS, "DMVV_BIND_PLACEMENTS", "Placements", "PlacementRecord", "placements");
  if (uses.lists) found(DMVV_BIND_CELLS, "DMVV_BIND_CELLS", "Cells", "uint", "cells");
  if (uses.lists) found(DMVV_BIND_LISTS, "DMVV_BIND_LISTS", "Lists", "uint", "lists");
  if (uses.walker) {
    buffer("DMVV_BIND_NODES", "Nodes", "NodeRecord", "nodes");
    buffer("DMVV_BIND_SDFS", "Sdfs", "SdfRecord", "sdfs");
    buffer("DMVV_BIND_GROUPS", "Groups", "GroupRecord", "groups");
    buffer("DMVV_BIND_OBJECTS", "Objects", "uint", "objects");
  }
  if (uses.tapes) found(DMVV_BIND_TAPE_CELLS, "DMVV_BIND_TAPE_CELLS", "TapeCells", "uint", "tape_cells");
  if (uses.tapes) found(DMVV_BIND_TAPES, "DMVV_BIND_TAPES", "Tapes", "uvec2", "tapes");
  if (uses.scalings) found(DMVV_BIND_SCALINGS, "DMVV_BIND_SCALINGS", "Scalings", "vec4", "scalings");
  if (uses.parameters) found(DMVV_BIND_PARAMETERS, "DMVV_BIND_PARAMETERS", "Parameters", "uvec4", "parameters");
  if (uses.time) buffer("DMVV_BIND_TIME", "TimeValues", "float", "time_values");
  if (uses.walker || uses.region_colors) buffer("DMVV_BIND_REGIONS", "Regions", "RegionRecord", "regions");
  return text;
}

/// `stage`: of the kernel `pixels` this one alone.
std::string kernel_text(const Evaluation& evaluation, std::uint32_t depth, Kernel kernel, RecordAccess access,
                        std::optional<std::size_t> stage) {
  const Uses& uses = evaluation.uses;
  const bool own_filter = uses.grid_atlas && evaluation.filter != Filter::hardware;
  std::string text = "#version 460\n";
  text += fmt::format("#define DMVV_DEPTH {}\n", depth);
  if (kernel == Kernel::points) text += "#define DMVV_PATHS\n";
  if (uses.reach) text += "#define DMVV_REACH\n";
  if (kernel == Kernel::leaders) text += "#define DMVV_LEADERS\n";
  if (stage) text += fmt::format("#define DMVV_STAGE {}\n", *stage);
  if (stage && evaluation.stages[*stage].has_next) text += "#define DMVV_STAGES_FOLLOW\n";
  if (access == RecordAccess::texels) text += "#define DMVV_TEXELS\n";
  if (uses.lists) text += "#define DMVV_LISTS\n";
  if (uses.placements) text += "#define DMVV_PLACEMENTS\n";
  if (uses.scalings) text += "#define DMVV_SCALINGS\n";
  if (uses.parameters) text += "#define DMVV_PARAMETERS\n";
  if (uses.tapes) text += "#define DMVV_TAPES\n";
  if (uses.grid_atlas) text += "#define DMVV_GRIDS\n";
  if (own_filter) text += "#define DMVV_FILTER\n";
  if (own_filter && evaluation.filter == Filter::tricubic) text += "#define DMVV_TRICUBIC\n";
  if (!evaluation.functions.empty()) text += "#define DMVV_FUNCTIONS\n";
  text += shader_text::records;
  text += bindings(uses, access);
  text += shader_text::access;
  if (kernel != Kernel::points) text += shader_text::surface;
  if (kernel != Kernel::points) text += shader_text::pixel_io;
  if (stage) text += shader_text::queues;
  text += shader_text::evaluate;
  if (uses.reach) text += shader_text::reach;
  if (own_filter) text += shader_text::filter;
  text += evaluation.functions;
  if (uses.walker) text += evaluation.codegen == Codegen::thesis ? shader_text::walk_thesis : shader_text::walk;
  text += "\n// ---- the scene ----\n";
  text += stage ? evaluation.stages[*stage].glsl + fmt::format("void evaluate(vec3 p) {{ stage_{}(p); }}\n", *stage)
                : evaluation.glsl;
  text += kernel == Kernel::points ? shader_text::points : shader_text::pixels;
  return text;
}

}  // namespace

std::string generate_glsl(const Evaluation& evaluation, std::uint32_t depth, Kernel kernel, RecordAccess access) {
  return kernel_text(evaluation, depth, kernel, access, std::nullopt);
}

std::string generate_stage_glsl(const Evaluation& evaluation, std::uint32_t depth, std::size_t stage,
                                RecordAccess access) {
  return kernel_text(evaluation, depth, Kernel::pixels, access, stage);
}

}  // namespace dmvv::compiler
