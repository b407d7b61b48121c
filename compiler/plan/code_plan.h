// Which objects become code and which are walked over their records: sizes after inlining, estimated, and cuts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/ir/module.h"
#include "compiler/plan/codegen.h"
#include "compiler/plan/cost_model.h"

namespace dmvv::compiler {

/// What an object's own code consists of.
struct ObjectParts {
  std::vector<Id<Sdf>> sdfs;        ///< different ones, in the order of the tree
  std::vector<Id<Region>> regions;  ///< different ones, in the order of the tree
  std::uint32_t decisions = 0;      ///< the tree has so many when it is written out, shared subtrees repeated
  std::uint32_t depth = 0;          ///< most decisions on a way through the tree
  bool has_flat_tree = false;       ///< then decisions are written once each, none within another
  std::uint32_t seeded = 0;         ///< so many decisions test a seeded SDF
  std::uint32_t source_lines = 0;   ///< snippets and filters take so many lines
};

/// What the sources of distances take in a shader.
struct SourceSizes {
  std::vector<std::uint32_t> function_lines;  ///< of each function of the module
  std::uint32_t function_nesting = 0;         ///< most conditions nested in one of them
  std::uint32_t filter_lines = 0;             ///< of a grid sample beyond a texture lookup
};

struct PlanOptions {
  Codegen codegen;
  std::uint32_t inlined_line_budget;
  DeviceCosts costs;  ///< for Codegen::automatic
};

struct CodePlan {
  std::vector<ObjectParts> parts;                           ///< of each object
  std::vector<std::vector<std::vector<Id<Object>>>> calls;  ///< of each region and group: the different objects
  std::vector<bool> cut;                                    ///< objects that are walked
  std::vector<bool> needed;                                 ///< objects that are called at all
  std::uint32_t inlined_lines = 0;                          ///< estimate of the evaluation after inlining
  std::vector<std::vector<std::uint32_t>> group_lines;      ///< of each region and group: likewise, of what it calls
  std::vector<std::string> object_forms;                    ///< of each object: which form it got, and why

  bool walks() const;  ///< is any object cut?
};

/// Cuts objects until the inlined size is within the budget. Each step takes the one cut that suffices and keeps most
/// code; if none suffices, the cut that saves most. In the end the root itself is cut. Objects that would nest too many
/// conditions are cut in any case, and all of them for a form that is only records.
/// Codegen::automatic cuts beforehand the objects that are expected to cost less when they are walked.
/// `alike`: of each object the one whose code it shares where both are candidates of a group (else itself).
/// Cost: objects squared, times cuts.
CodePlan plan_code(const Module& module, const SourceSizes& sizes, const std::vector<Id<Object>>& alike,
                   const PlanOptions& options);

}  // namespace dmvv::compiler
