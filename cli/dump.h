// What the compiler made, as text and files a person can read: `dmvv compile --dump`.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"
#include "compiler/program.h"

namespace dmvv::cli {

/// SPIR-V assembly with friendly names, as spirv-dis prints it.
Result<std::string> disassemble(std::span<const std::uint32_t> spirv);

/// A 3D texture as an EXR picture (float32 or half, as stored): slice z stands below slice z-1.
Result<void> write_texture(const std::string& path, const compiler::Texture& texture);

/// Extent, format and size of the program's textures.
std::string textures_text(const compiler::Program& program);

std::string statistics_text(const compiler::Program& program);

}  // namespace dmvv::cli
