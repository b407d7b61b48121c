// Inside the compiler only: what generate_evaluation is made of, a file for each part of a scene.
//   generate_glsl.cpp     what is written, in which order; snippets
//   generate_sdfs.cpp     distance functions, and how far their answers hold
//   generate_objects.cpp  decisions; objects in two steps
//   generate_lists.cpp    embedded objects: groups of candidates
//   generate_stages.cpp   the evaluation in parts
//   generate_occupancy.cpp  whether anything is at a point
//   generate_colors.cpp   colours of regions
#pragma once

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "compiler/glsl/families.h"
#include "compiler/glsl/generate_glsl.h"
#include "compiler/glsl/glsl_text.h"
#include "compiler/ir/rounding.h"
#include "compiler/passes/seed_chains.h"
#include "compiler/plan/code_plan.h"
#include "compiler/plan/stage_plan.h"

namespace dmvv::compiler {

/// How groups are written that stages divide.
struct Continuation {
  std::size_t first = 0;   ///< the groups before it have been asked
  bool asks_first = true;  ///< in this stage
  const Way* way = nullptr;
  std::string last;  ///< what is called for the last group's one candidate; "": its usual function
  std::optional<std::uint32_t> stage_of(const StagePlan& plan, std::size_t group) const {
    return way == nullptr || (asks_first && group == first) ? std::nullopt : plan.stage_at(*way, group);
  }
};

class Generator : GlslWriter {
 public:
  Generator(const Module& module, const Records& records, const Atlas& grid_atlas, const GlslOptions& options)
      : module_(module), records_(records), grid_atlas_(grid_atlas), options_(options) {
    for (const SeedChain& chain : records.chains) {
      for (std::uint32_t i = 0; i < chain.size(); ++i) links_.emplace(chain[i], Link{&chain, i});
    }
  }
  Evaluation run();

 private:
  static constexpr std::uint32_t no_budget = ~0u;
  /// The functions of the scene, as the plan says.
  void write(CodePlan plan);
  /// What a kernel calls, and before it the root object with all that it calls.
  std::vector<std::string> scene_functions() const;
  Evaluation finish();
  /// What was written since the last time, as a function.
  void add(const std::string& name) { families_.add(name, take()); }

  // ---- snippets ----
  std::string function_name(Id<Function> id) const { return fmt::format("function_{}", id.index); }
  bool is_tape(Id<Function> id) const { return !tape_walker_.empty() && options_.tapes->functions[id.index].is_tape; }
  void measure_sources();
  void emit_functions();
  void use_walker();
  void use_rays();
  /// What the walker calls.
  std::vector<std::string> walker_functions() const;
  /// The thesis' stitching: one function that the walker calls with the number of a snippet.
  void emit_function_switch();
  /// By halves: drivers make nested conditions of a switch, as many as it has cases.
  void emit_function_choice(std::uint32_t first, std::uint32_t end);
  std::uint32_t filter_lines() const;

  // ---- what calls what ----
  std::vector<Id<Object>> each_by_itself() const;
  /// Gives each object the first one of its shape, among those that are written.
  std::vector<Id<Object>> by_shape() const;
  /// A group of one candidate calls its object unconditionally, with a guard: so embedding does not nest.
  void find_guarded();

  // ---- distance functions ----
  std::string sdf_name(Id<Sdf> id) const { return fmt::format("negative_{}", id.index); }
  /// `f(local) <= iso` as one expression, the local point being q, or constant(q) if that is given.
  std::string source_test(Id<Sdf> id, const Affine* constant, const std::string& q);
  /// `value <= iso`, the value being that of the source over `scale`.
  std::string comparison(Id<Sdf> id, const std::string& value, double scale, const Affine* constant,
                         const std::string& q) const;

  // ---- how far answers hold (shaders/reach.glsl) ----
  bool reaches() const { return options_.steepness != nullptr && !stage_; }
  /// A literal; what is infinite, or nearly, as a number that leaves no reach.
  static std::string bound(double value);
  /// How far off a point of the standard cube is after the map, in units of its result.
  static double rounding_of(const Affine& affine) { return glm::length(float_error(affine, glm::dvec3(1.0))); }
  static std::string mat3_literal(const glm::dmat3& m);
  /// Writes by how much steps are longer in the frame that `affine` leads to, and how far a point there may be off.
  static std::string scaled_frame(const Affine& affine);
  /// Bounds that hold for all placements of a list, since their matrices are not known when the code is written.
  struct Placements {
    double skew = 1.0;   ///< the largest stretch over the longest row
    double error = 0.0;  ///< how far a point may be off, as a step in the outer frame
    void add(const Affine& affine) {
      const glm::dmat3 rows = glm::transpose(affine.linear);
      const double longest = std::max({glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2])});
      const double stretch = largest_stretch(affine.linear);
      skew = std::max(skew, stretch / longest);
      error = std::max(error, rounding_of(affine) / stretch);
    }
    std::string frame(const std::string& affine) const {
      return fmt::format("placed(outer, {}, {}, {})", affine, bound(skew), bound(error));
    }
  };
  std::string limit_box(const LocalBox& box, const std::string& q, double slope, double error) const;
  /// Writes a function that tells of which regions something holds.
  void emit_region_test(const std::string& name, const std::function<bool(const Region&)>& holds);
  /// Writes how far a ray may step in a medium.
  void emit_medium_step();
  std::string box_test(const LocalBox& box, const std::string& q) const;
  /// Tells where an SDF stands in its chain (compiler/passes/seed_chains.h).
  struct Link {
    const SeedChain* chain;
    std::uint32_t number;
    bool is_first() const { return number == 0; }
  };
  const Link* link_of(Id<Sdf> id) const {
    const auto found = links_.find(id);
    return found != links_.end() ? &found->second : nullptr;
  }
  static std::string chain_name(const SeedChain& chain) { return fmt::format("first_of_{}", chain.front().index); }
  /// Whether the SDF is negative at p, as one expression in brackets or a call. `asks`: of a chain nothing has been
  /// asked yet.
  std::string decision_test(Id<Sdf> id, bool asks) const;
  /// Likewise; asks a chain where its first test stands.
  std::string decision_test(Id<Sdf> id);
  void emit_sdf(Id<Sdf> id);
  void emit_single(Id<Sdf> id, const Sdf& sdf);
  /// Whether q lies in the box and is negative. Outside of it nothing is, so a positive point may cross its walls.
  void emit_boxed_test(const std::string& result, const LocalBox& box, Id<Sdf> id);
  void emit_tiled(Id<Sdf> id, const Sdf& sdf);
  /// Three, even if they are equal: the shape does not depend on the values.
  static std::string components(const glm::vec4& v);
  std::string find_cell(const gpu::LookupRecord& lookup, const std::string& p);
  /// The range of p's cell in the lists.
  void emit_range(const gpu::LookupRecord& lookup, const std::string& p);
  void emit_seeded(Id<Sdf> id, const Sdf& sdf);
  void emit_chain(const SeedChain& chain);
  /// Finds the first seed of p's cell that is negative: `bool negative`, and its number in the list's count, `seed`.
  void emit_seed_search(std::span<const Id<Sdf>> sdfs);

  // ---- objects ----
  static std::string object_name(Id<Object> id) { return fmt::format("object_{}", id.index); }
  std::string call(Id<Object> object, const std::string& p, const std::string& level,
                   const std::string& guard = "true") const;
  void emit_object(Id<Object> id);

  // ---- objects in two steps: whether they answer, and what ----
  /// What becomes of a point at a node or below it, as far as the decisions tell.
  enum class Outcome : std::uint8_t { misses, answers, either };
  Outcome outcome_of(Id<Node> id);
  /// Do the object's decisions tell, before what it embeds is asked, whether it answers?
  bool sinks(Id<Object> id);
  /// Writes a function that is called twice: `inside = false` returns whether the object answers at p; `inside = true`
  /// then computes the answer.
  void emit_in_two_steps(Id<Object> id);
  /// Whether a point answers, as one expression.
  std::string entrance(Id<Node> id);
  /// The function that a list calls for an object.
  std::string listed_name(Id<Object> id) { return object_name(id) + (sinks(id) ? "_listed" : ""); }
  /// `condition` where the object's code is guarded also that it is asked; "" is no condition.
  std::string guarded(const std::string& condition) const;
  void emit_decisions(Id<Node> root, bool flat);
  /// One decision after the other, parents first; `at` is the decision or region that the point has come to.
  void emit_flat_tree(Id<Node> root);
  void emit_tree(Id<Node> id);
  void emit_candidates(Id<Region> id, bool one_region, const Continuation& continued = {});
  void emit_group(Id<Region> region, std::size_t g, const gpu::GroupRecord& record, const std::string& asked,
                  std::optional<std::uint32_t> later);
  /// Writes the test of point b in the frame of a group's box.
  std::string limit_group_box(const Affine& box_from_object) const;
  /// The call stands in no condition: a chain of objects, each in the one before, is as deep as one.
  /// `called`: the object's function, if it is not its usual one.
  void emit_one_candidate(Id<Region> region, const CandidateGroup& group, const std::string& asked,
                          const std::string& called);
  /// Where a group's candidates are asked, q being a point in the frame of one.
  struct CubeTest {
    std::string holds;  ///< is q there?
    std::string limit;  ///< how far q's answer holds, by that
  };
  /// In one box if all objects have it; else each where its record says.
  CubeTest cube_test(const std::set<Id<Object>>& objects, const std::string& tags) const;
  /// With a `later` stage only the search for a candidate, which that stage then asks.
  void emit_candidate_loop(Id<Region> region, std::size_t g, const gpu::GroupRecord& record,
                           std::optional<std::uint32_t> later);
  /// To the next candidate whose cube holds the point. A loop of its own: all points search, then all that have found
  /// one evaluate it (Aila and Laine 2009, while-while), and the evaluation's rounds are no more than a point's finds.
  void emit_search(const gpu::GroupRecord& record, bool any_tiled, const Placements& candidates, const CubeTest& cube);
  /// How the objects of a list are called: one call for each different shape, one walker for all objects that are cut.
  struct Calls {
    struct Call {
      std::string condition;  ///< "object == 3u"
      std::string called;     ///< up to what follows the point's level
      std::string guard;      ///< the arguments after it
      bool sinks;             ///< in two steps
    };
    std::string placement;
    std::vector<Call> calls{};
    std::optional<Id<Object>> walked{};  ///< one of those that are walked, if any are
    bool by_object = false, by_family = false;

    bool chooses() const { return calls.size() + (walked ? 1u : 0u) > 1; }
    bool sinks() const { return std::ranges::any_of(calls, &Call::sinks); }
    bool answers_at_once() const { return walked || !std::ranges::all_of(calls, &Call::sinks); }
  };
  Calls calls_of(const std::vector<Id<Object>>& called, const gpu::GroupRecord& record);
  /// Writes the call of candidate c. In two steps, `inside` calls those for their answer that were found to have one.
  void emit_calls(const Calls& calls, bool inside);
  /// Objects by shape, in the order of the first of each; those that are cut all together.
  std::vector<std::vector<Id<Object>>> shapes_of(const std::vector<Id<Object>>& called);
  /// The number of the family that the objects belong to, from 1: 0 is that of objects without.
  std::uint32_t unite(const std::vector<Id<Object>>& alike);
  /// Nobody inside answered: the region's own colour counts, unless it is empty.
  void emit_own_answer(const std::vector<Id<Region>>& regions, bool one_region);

  // ---- stages (compiler/plan/stage_plan.h) ----
  static std::string stage_name(std::uint32_t stage) { return fmt::format("stage_{}", stage); }
  std::string nobody() const {
    if (asks_whether_) return "!occupied";
    return stage_ ? "hit_number == 0u && next_stage == 0u" : "hit_number == 0u";
  }
  void emit_stages();
  /// Stage `number`, whose functions `emit` writes.
  void emit_stage(std::uint32_t number, const std::function<void()>& emit);
  /// From a group of a region on: the way to there is entered already.
  void emit_stage_from(std::uint32_t number, const Way& way, std::size_t group);
  /// What is called for the one candidate of a region's last group, if that may be divided.
  std::string emit_last(const Way& way);
  /// An object as a stage has it: where its regions' groups are divided off, the stages are told that hold them.
  std::string emit_divided(const Way& way, Id<Object> id);

  // ---- whether anything is at a point ----
  static std::string occupied_name(Id<Object> id) { return fmt::format("occupied_{}", id.index); }
  /// Writes `void occupancy(vec3 p)`.
  void emit_occupancy();
  /// Do an object's decisions tell, before what it embeds is asked, whether it answers?
  bool is_told_by_decisions(Id<Object> id) const;
  void emit_occupied(Id<Object> id);
  /// Writes whether a node answers, into the bool `result`; limited by what it depends on.
  void emit_told(Id<Node> id, const std::string& result);
  /// Writes a test: `negative`, and what limits it: `asked`.
  void emit_asked(Id<Sdf> sdf);
  /// Writes what a region calls that is empty but for what it embeds.
  void emit_occupied_below(const Region& region);
  void emit_occupied_regions(Id<Object> id);

  // ---- colours ----
  void emit_colors();
  void emit_constant_colors();
  void emit_record_colors();

  const Module& module_;
  const Records& records_;
  const Atlas& grid_atlas_;
  const GlslOptions& options_;
  Evaluation out_;
  SourceSizes sizes_;
  CodePlan plan_;
  std::vector<bool> guarded_;  ///< objects whose function has a guard
  std::string guard_;          ///< of the function that is being written; "" if it has none
  std::string tape_walker_;    ///< empty if no function is a tape
  std::map<Id<Node>, Outcome> outcomes_;
  bool is_inside_ = false;     ///< what is written is reached only by points that get an answer
  bool asks_whether_ = false;  ///< what is written tells only whether anything is there
  StagePlan stages_;
  std::optional<std::uint32_t> stage_;  ///< that is being written
  std::uint32_t divided_ = 0;           ///< its objects so far
  std::set<Id<Sdf>> emitted_;
  std::map<Id<Sdf>, Link> links_;
  const SeedChain* asked_chain_ = nullptr;  ///< on the way to the decision that is being written
  Families families_;
  std::vector<std::string> united_names_;               ///< of each family of objects
  std::map<Id<Object>, std::uint32_t> united_objects_;  ///< their families
};

}  // namespace dmvv::compiler
