#include "cli/dump.h"

#include <fmt/format.h>
#include <spirv-tools/libspirv.h>

#include <cstring>

#include "voml/assets/image_file.h"

namespace dmvv::cli {
namespace {

std::string_view name_of(compiler::TexelFormat format) {
  switch (format) {
    case compiler::TexelFormat::r32f:
      return "r32f";
    case compiler::TexelFormat::r16f:
      return "r16f";
    case compiler::TexelFormat::snorm16:
      return "snorm16";
    case compiler::TexelFormat::snorm8:
      return "snorm8";
    case compiler::TexelFormat::unorm8:
      return "unorm8";
    case compiler::TexelFormat::rgba16f:
      return "rgba16f";
  }
  return "?";
}

std::string_view name_of(compiler::Codegen codegen) {
  switch (codegen) {
    case compiler::Codegen::specialised:
      return "specialised";
    case compiler::Codegen::table:
      return "table";
    case compiler::Codegen::thesis:
      return "thesis";
    case compiler::Codegen::automatic:
      return "auto";
  }
  return "?";
}

template <class T>
std::vector<float> divided(std::span<const std::byte> bytes, float by) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  std::vector<float> floats;
  for (const T value : values) floats.push_back(static_cast<float>(value) / by);
  return floats;
}

/// Empty for formats of floats.
std::vector<float> normalised_texels(const compiler::Texture& texture) {
  switch (texture.format) {
    case compiler::TexelFormat::snorm16:
      return divided<std::int16_t>(texture.texels, 32767.0f);
    case compiler::TexelFormat::snorm8:
      return divided<std::int8_t>(texture.texels, 127.0f);
    case compiler::TexelFormat::unorm8:
      return divided<std::uint8_t>(texture.texels, 255.0f);
    default:
      return {};
  }
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

/// EXR has no normalised formats: their texels are written as the floats that a shader reads.
Result<void> write_texture(const std::string& path, const compiler::Texture& texture) {
  const bool is_rgba = texture.format == compiler::TexelFormat::rgba16f;
  const std::vector<float> read = normalised_texels(texture);
  const bool is_float = !read.empty() || texture.format == compiler::TexelFormat::r32f;
  const SampleType type = is_float ? SampleType::f32 : SampleType::f16;
  return write_image(
      path, {.width = texture.extent.x,
             .height = std::uint64_t{texture.extent.y} * texture.extent.z,
             .channels = is_rgba ? std::vector<std::string>{"R", "G", "B", "A"} : std::vector<std::string>{"Y"},
             .stored = type,
             .given = type,
             .straight_alpha = false,
             .compression = "zip",
             .samples = read.empty() ? static_cast<const void*>(texture.texels.data()) : read.data()});
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
      "inlined_lines   {}\n"
      "stages          {}\n",
      name_of(program.codegen), s.scene.objects, s.scene.sdfs, s.scene.nodes, s.scene.regions, s.scene.candidates,
      s.scene.seeds, s.scene.depth, s.bytes.buffers, s.bytes.textures, s.bytes.atlas_fill, s.code.glsl_lines,
      s.code.inlined_lines, s.code.stages);
  for (const compiler::ObjectForm& object : s.objects)
    result += fmt::format("object          {}: {}\n", object.object, object.form);
  for (const std::string& tape : s.tapes) result += fmt::format("tape            {}\n", tape);
  return result;
}

}  // namespace dmvv::cli
