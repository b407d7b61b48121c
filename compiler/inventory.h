// What compiling makes of each object of a module, and what the passes found: for `dmvv info`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/compile.h"

namespace dmvv::compiler {

/// An object after the passes.
struct ObjectInventory {
  std::string name;
  std::string codegen;  ///< "specialised", "table, below an object that was cut", ...
  std::uint32_t decisions = 0, sdfs = 0, regions = 0;
  std::uint32_t placements = 0;    ///< seeds, embedded objects, and one for each SDF that stands once
  std::uint64_t record_bytes = 0;  ///< of the buffers that the program uploads; the sum over all objects is theirs
  std::uint64_t texels = 0;        ///< samples of the different grids and bitmaps it reads; others may read them too
  std::uint64_t texel_bytes = 0;
  std::vector<std::string> moving_sdfs;  ///< names of those that depend on t, in the order of the module
};

struct PassEffect {
  std::string_view pass;  ///< a name of pass_names()
  std::string effect;     ///< "grids 5 -> 3, functions 4 -> 2"; "off"; empty if it is not known
};

struct Inventory {
  std::vector<ObjectInventory> objects;  ///< those that are left, in the module's order
  std::vector<PassEffect> passes;        ///< in the order of pass_names()
  Program program;                       ///< without SPIR-V
};

/// Compiles the module and takes stock.
/// In:     options for any form but Codegen::thesis, whose records are others.
/// Errors: those of compile.
/// Cost:   that of compile, the lookup grids twice.
std::optional<Inventory> take_inventory(Module module, const CompileOptions& options, Diagnostics& diagnostics);

}  // namespace dmvv::compiler
