// Large snippets as tapes, shortened for each cell of a grid by what intervals prove there.
//
// A driver takes seconds to compile thousands of lines, and every pixel pays for all of them. A tape is data: the
// shader holds one loop that walks it (shaders/tape.glsl), and a cell of the snippet's cube needs only what can decide
// the side of a point in it. Most cells need nothing: their side is known.
//
// Source: Keeter 2020, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces" (MPR), and fidget.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "compiler/ir/module.h"
#include "compiler/layout/tape_options.h"
#include "compiler/snippet/tape.h"
#include "shaders/records.h"

namespace dmvv::compiler {

/// What a function of the module becomes.
struct FunctionTape {
  bool is_tape = false;  ///< else it is written out
  std::uint32_t first_cell = 0;
  std::uint32_t cells_a_side = 1;
  std::string note;  ///< for people: "8,123 steps; ...", or why a large one is written out; empty for a small one
};

/// The tapes of all functions of a module, as the GPU reads them (shaders/records.h).
struct Tapes {
  std::vector<FunctionTape> functions;  ///< one a function
  std::vector<std::uint32_t> cells;     ///< x fastest; DMVV_TAPE_POSITIVE, DMVV_TAPE_NEGATIVE or the place of a tape
  std::vector<glm::uvec2> words;
  std::uint32_t registers = DMVV_TAPE_FIRST_FREE;  ///< most of any tape
  snippet::TapeCodes codes;

  bool any() const { return !words.empty(); }
};

/// Makes the tapes. A cell's tape decides `f <= iso` like the whole snippet does for every point that a device finds in
/// the cell, for each iso of the SDFs that use the function, at all times.
/// Cost: most_work steps over boxes, on all cores; the same module gives the same bytes.
Tapes make_tapes(const Module& module, const TapeOptions& options);

/// The walker as GLSL, for a text that has shaders/evaluate.glsl before it: tape_operation and walk_tape.
std::string tape_walker(const Tapes& tapes);

/// A function of the module that is a tape: `float NAME(vec3 q)`. Its time values begin at FIRST.
std::string tape_call(const std::string& name, const FunctionTape& tape, std::size_t first_time_value);

}  // namespace dmvv::compiler
