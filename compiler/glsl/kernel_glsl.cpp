#include <fmt/format.h>

#include <optional>

#include "compiler/glsl/generate_glsl.h"
#include "compiler/glsl/kernel.h"
#include "compiler/grids/storage.h"
#include "compiler/layout/scene_buffers.h"
#include "compiler/plan/codegen.h"
#include "compiler/shader_text.h"
#include "shaders/records.h"

namespace dmvv::compiler {

namespace {

std::string_view format_name(BufferForm form) {
  if (form == BufferForm::r32ui) return "r32ui";
  return form == BufferForm::rg32ui ? "rg32ui" : "rgba32ui";
}

std::string declaration(const SceneBuffer& buffer, RecordAccess access) {
  const BufferForm form = buffer.form(access);
  if (form != BufferForm::records) {
    return fmt::format("layout(set = 0, binding = {}, {}) readonly uniform uimageBuffer {};\n", buffer.binding,
                       format_name(form), buffer.name);
  }
  return fmt::format("layout(set = 0, binding = {0}, std430) readonly buffer buffer_{1} {{ {2} {1}[]; }};\n",
                     buffer.binding, buffer.name, buffer.element);
}

bool is_of_rays(Source source) { return source == Source::rays || source == Source::hits; }

std::string_view main_of(const KernelSpec& kernel) {
  switch (kernel.source) {
    case Source::points:
      return shader_text::points;
    case Source::surface:
      return shader_text::pixels;
    case Source::rays:
      return shader_text::rays;
    case Source::hits:
      return kernel.query.medium ? shader_text::media : shader_text::normals;
  }
  return {};
}

std::string bindings(const Uses& uses, RecordAccess access) {
  std::string text;
  const auto sampler = [&](const char* slot, const char* name) {
    text += fmt::format("layout(set = 0, binding = {}) uniform sampler3D {};\n", slot, name);
  };
  if (uses.grid_atlas) sampler("DMVV_BIND_GRID_ATLAS", "grid_atlas");
  if (uses.bitmap_atlas) sampler("DMVV_BIND_BITMAP_ATLAS", "bitmap_atlas");
#define DMVV_SCENE_BUFFER(name, number, element, texels, present, contents) \
  if (present) text += declaration(*find_scene_buffer(number), access);
#include "compiler/layout/scene_buffers.def"
#undef DMVV_SCENE_BUFFER
  return text;
}

}  // namespace

std::string generate_glsl(const Evaluation& evaluation, std::uint32_t depth, const KernelSpec& kernel,
                          RecordAccess access, std::optional<std::size_t> stage) {
  const Uses& uses = evaluation.uses;
  const bool own_filter = uses.grid_atlas && evaluation.filter != Filter::hardware;
  std::string text = "#version 460\n";
  text += fmt::format("#define DMVV_DEPTH {}\n", depth);
  if (kernel.query.path) text += "#define DMVV_QUERY_PATH\n";
  if (uses.reach) text += "#define DMVV_REACH\n";
  if (kernel.query.radius) text += "#define DMVV_QUERY_RADIUS\n";
  if (kernel.query.gradient) text += "#define DMVV_QUERY_GRADIENT\n";
  if (kernel.query.medium) text += "#define DMVV_QUERY_MEDIUM\n";
  if (uses.media) text += "#define DMVV_MEDIA\n";
  if (is_of_rays(kernel.source)) text += "#define DMVV_DRAWS_SURFACE\n";
  if (stage) text += fmt::format("#define DMVV_STAGE {}\n", *stage);
  if (stage && evaluation.stages[*stage].has_next) text += "#define DMVV_STAGES_FOLLOW\n";
  if (access == RecordAccess::texels) text += "#define DMVV_TEXELS\n";
  if (uses.lists) text += "#define DMVV_LISTS\n";
  if (uses.lists && uses.reach) text += "#define DMVV_GAPS\n";
  if (uses.placements) text += "#define DMVV_PLACEMENTS\n";
  if (uses.scalings) text += "#define DMVV_SCALINGS\n";
  if (uses.parameters) text += "#define DMVV_PARAMETERS\n";
  if (uses.tapes) text += "#define DMVV_TAPES\n";
  if (uses.grid_atlas) text += "#define DMVV_GRIDS\n";
  if (own_filter) text += "#define DMVV_FILTER\n";
  if (own_filter && evaluation.filter == Filter::tricubic) text += "#define DMVV_TRICUBIC\n";
  if (evaluation.has_function_switch) text += "#define DMVV_FUNCTIONS\n";
  text += shader_text::records;
  text += bindings(uses, access);
  text += shader_text::access;
  if (kernel.source != Source::points) text += shader_text::surface;
  if (kernel.source != Source::points) text += shader_text::pixel_io;
  if (is_of_rays(kernel.source)) text += shader_text::rays_h;
  if (is_of_rays(kernel.source)) text += shader_text::ray;
  if (stage) text += shader_text::queues;
  text += shader_text::evaluate;
  if (uses.reach || (uses.walker && evaluation.codegen != Codegen::thesis)) text += shader_text::reach;
  if (own_filter) text += shader_text::filter;
  text += evaluation.functions;
  if (uses.walker) text += evaluation.codegen == Codegen::thesis ? shader_text::walk_thesis : shader_text::walk;
  text += "\n// ---- the scene ----\n";
  // Behind media, what rays meet is no boundary of what is occupied.
  const bool asks_whether = kernel.source == Source::rays || (kernel.query.gradient && !uses.media);
  if (asks_whether)
    text += evaluation.occupancy;
  else
    text += stage ? evaluation.stages[*stage].glsl + fmt::format("void evaluate(vec3 p) {{ stage_{}(p); }}\n", *stage)
                  : evaluation.glsl;
  if (kernel.query.gradient && !asks_whether) text += evaluation.function_switch;
  if (kernel.query.gradient) text += shader_text::gradient;
  text += main_of(kernel);
  return text;
}

}  // namespace dmvv::compiler
