// Scenes of the render tests, and pictures as they come back from the program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/ir/module.h"
#include "runtime/runtime.h"
#include "tests/cli/program.h"

namespace dmvv::tests {

/// With validation layers on; opened once.
runtime::Device& device();

/// A scene that exercises one thing, its files written into a folder.
struct RenderScene {
  std::string name;
  std::string path;
};

/// Grids, seeds, tiling, embeddings with rotations and lookup boxes, bitmaps.
std::vector<RenderScene> write_render_scenes(const Folder& folder);

/// One channel of an EXR picture, as it is stored, rows from the top.
std::vector<std::uint32_t> read_regions(const std::string& path);
std::vector<float> read_depth(const std::string& path);
/// RGBA of a PNG picture.
std::vector<std::uint8_t> read_rgba8(const std::string& path);

}  // namespace dmvv::tests
