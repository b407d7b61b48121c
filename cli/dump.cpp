#include "cli/dump.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <spirv-tools/libspirv.h>

namespace dmvv::cli {
namespace {

std::string_view name_of(compiler::TexelFormat format) {
  switch (format) {
    case compiler::TexelFormat::r32f:
      return "r32f";
    case compiler::TexelFormat::r16f:
      return "r16f";
    case compiler::TexelFormat::rgba16f:
      return "rgba16f";
  }
  return "?";
}

}  // namespace

Result<std::string> disassemble(std::span<const std::uint32_t> spirv) {
  constexpr std::uint32_t options =
      SPV_BINARY_TO_TEXT_OPTION_INDENT | SPV_BINARY_TO_TEXT_OPTION_FRIENDLY_NAMES | SPV_BINARY_TO_TEXT_OPTION_NO_HEADER;
  const spv_context context = spvContextCreate(SPV_ENV_VULKAN_1_2);
  spv_text text = nullptr;
  const spv_result_t status = spvBinaryToText(context, spirv.data(), spirv.size(), options, &text, nullptr);
  std::string assembly = text ? std::string(text->str, text->length) : std::string();
  spvTextDestroy(text);
  spvContextDestroy(context);
  if (status != SPV_SUCCESS) return fail(Fault::environment, "SPIRV-Tools cannot disassemble the generated SPIR-V");
  return assembly;
}

Result<void> write_texture(const std::string& path, const compiler::Texture& texture) try {
  const bool is_rgba = texture.format == compiler::TexelFormat::rgba16f;
  const OIIO::TypeDesc type =
      texture.format == compiler::TexelFormat::r32f ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::HALF;
  OIIO::ImageSpec spec(static_cast<int>(texture.extent.x), static_cast<int>(texture.extent.y * texture.extent.z),
                       is_rgba ? 4 : 1, type);
  if (!is_rgba) spec.channelnames = {"Y"};
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "1970:01:01 00:00:00");  // the same program gives the same bytes
  const auto file = OIIO::ImageOutput::create(path);
  if (!file || !file->open(path, spec) || !file->write_image(type, texture.texels.data()) || !file->close()) {
    return fail(Fault::environment, fmt::format("cannot write '{}'", path),
                {file ? file->geterror() : OIIO::geterror()});
  }
  return {};
} catch (const std::exception& error) {
  return fail(Fault::environment, fmt::format("cannot write '{}'", path), {error.what()});
}

std::string textures_text(const compiler::Program& program) {
  std::string result;
  for (const compiler::Texture& texture : program.textures) {
    result += fmt::format("{}: binding {}, {} x {} x {} texels {}, {} bytes\n", texture.name, texture.binding,
                          texture.extent.x, texture.extent.y, texture.extent.z, name_of(texture.format),
                          texture.texels.size());
    result += fmt::format("  {}.exr: slice z holds its rows {} * z to {} * z + {}\n", texture.name, texture.extent.y,
                          texture.extent.y, texture.extent.y - 1);
  }
  return result.empty() ? "no textures\n" : result;
}

std::string statistics_text(const compiler::Program& program) {
  const compiler::Statistics& s = program.statistics;
  std::string result = fmt::format(
      "codegen         {}\n"
      "objects         {}\n"
      "sdfs            {}\n"
      "nodes           {}\n"
      "regions         {}\n"
      "candidates      {}\n"
      "seeds           {}\n"
      "depth           {}\n"
      "buffer_bytes    {}\n"
      "texture_bytes   {}\n"
      "atlas_fill      {:.3f}\n"
      "glsl_lines      {}\n"
      "inlined_lines   {}\n",
      program.codegen == compiler::Codegen::table ? "table" : "specialised", s.objects, s.sdfs, s.nodes, s.regions,
      s.candidates, s.seeds, s.depth, s.buffer_bytes, s.texture_bytes, s.atlas_fill, s.glsl_lines, s.inlined_lines);
  for (const std::string& object : s.object_codegen) result += fmt::format("object          {}\n", object);
  return result;
}

}  // namespace dmvv::cli
