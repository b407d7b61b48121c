// Module + records -> the text of a kernel.
#pragma once

#include <glm/vec4.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compiler/glsl/kernel.h"
#include "compiler/grids/storage.h"
#include "compiler/layout/flatten.h"
#include "compiler/layout/scene_buffers.h"
#include "compiler/layout/tapes.h"
#include "compiler/plan/codegen.h"
#include "compiler/plan/cost_model.h"
#include "compiler/plan/stage_options.h"
#include "compiler/proofs/steepness.h"
#include "compiler/snippet/time_slot.h"

namespace dmvv::compiler {

/// Scene buffers that a shader text declares and uses; everything else need not be uploaded.
struct Uses {
  bool grid_atlas = false;
  bool bitmap_atlas = false;
  bool walker = false;  ///< nodes, sdfs, regions, groups, objects
  bool placements = false;
  bool lists = false;          ///< cells and lists
  bool tapes = false;          ///< tapes and their cells
  bool scalings = false;       ///< seeds that only scale and move
  bool parameters = false;     ///< of united functions
  bool time = false;           ///< what depends on time alone
  bool region_colors = false;  ///< regions, for their colours
  bool reach = false;          ///< the text tells how far its answers hold, if its kernel asks
  bool rays = false;           ///< sdfs, for gradients of what decides boundaries
  bool media = false;          ///< rays go through some regions
};

struct GlslOptions {
  Codegen codegen = Codegen::automatic;
  std::uint32_t inlined_line_budget = 4000;
  DeviceCosts costs;             ///< for Codegen::automatic
  bool fold_affine = true;       ///< write identities, translations and scalings as such
  bool box_tests = true;         ///< leave out box tests that the standard cube already answers
  const Tapes* tapes = nullptr;  ///< functions that are tapes; none: all are written out
  bool sink_answers =
      true;  ///< loops over candidates find the one that answers; what it answers is evaluated behind them
  bool unite_shapes = true;            ///< candidates' objects that are equal but for their numbers share one function
  std::optional<StageOptions> stages;  ///< none: all pixels are evaluated by one kernel
  bool write_stages = false;           ///< or only count them
  const std::vector<Steepness>* steepness = nullptr;  ///< of each SDF's source: for answers that tell how far they hold
  bool rays = false;                                  ///< there are kernels for rays
  bool media = false;                                 ///< and one for media
};

struct StageText {
  std::string glsl;
  bool has_next;  ///< its pixels may go on to later stages
};

/// The evaluation of a module: `void evaluate(vec3 p)` and `vec4 color_of(uint region, vec3 p)` with what they call.
struct Evaluation {
  std::string functions;  ///< the snippets, and `float call_function(uint function, vec3 q)` if the walker is in use
  std::string glsl;
  std::string function_switch;  ///< `call_function` where the walker does not need it
  std::string occupancy;  ///< `void occupancy(vec3 p)`, and what gradients call: in place of it for kernels of rays
  bool has_function_switch = false;  ///< there is `call_function`
  std::uint32_t united_functions = 0;
  std::map<Id<Object>, bool> listed;  ///< objects that loops call; whether by two steps (pass sink-answers)
  std::uint32_t stage_count = 0;      ///< 0: there are none
  std::vector<StageText> stages;  ///< the same in parts: stage k is `void stage_k(vec3 p)`, which may set next_stage
  std::vector<snippet::TimeSlot> time_slots;  ///< the buffer `time_values`, float by float
  std::vector<glm::uvec4> parameters;         ///< of united functions (compiler/glsl/families.h)
  std::map<Id<Object>, std::uint32_t>
      united;  ///< what PlacementRecord::united says where such an object is a candidate
  Uses uses;
  std::uint32_t inlined_lines = 0;
  Codegen codegen = Codegen::automatic;
  Filter filter = Filter::hardware;
  std::vector<std::string> object_forms;  ///< of each object: which form it got, and why
};

/// Generates the evaluation.
///
/// Specialised: every object becomes a function of nested branches with constant matrices; a run of candidates becomes
/// one loop with one call for each different object. Drivers inline every call, so the inlined size is estimated, and
/// beyond the budget objects are cut: they are walked over the records (shaders/walk.glsl).
/// Table: the root is cut. Thesis: likewise, and walked by shaders/walk_thesis.glsl over records of
/// compiler/thesis/thesis.h.
Evaluation generate_evaluation(const Module& module, const Records& records, const Atlas& grid_atlas,
                               const GlslOptions& options);

/// The complete text of a kernel's shader: version, records, bindings in use, evaluation, main.
std::string generate_glsl(const Evaluation& evaluation, std::uint32_t depth, const KernelSpec& kernel,
                          RecordAccess access, std::optional<std::size_t> stage = {});

/// Does the image of the standard cube lie in the box, float32 rounding included? Then `box_tests` leaves its test out.
bool cube_maps_into(const Affine& affine, const LocalBox& box);

}  // namespace dmvv::compiler
