// A slice is found backward: from the registers asked for to what assigns them, and to what decides whether it does.
#include "compiler/snippet/slice_program.h"

#include <utility>
#include <vector>

#include "compiler/snippet/operands.h"

namespace dmvv::compiler::snippet {

namespace {

/// Marks instructions and control flow backward from the results.
class Reach {
 public:
  explicit Reach(const Program& program)
      : program_(program),
        node_of_(program.instructions.size(), 0),
        needed_(program.instructions.size(), false),
        register_seen_(program.register_count(), false),
        array_seen_(program.arrays.size(), false),
        assignments_(program.register_count()),
        stores_(program.arrays.size()) {
    places_.push_back({});  // the whole program: always there
    places_[0].needed = true;
    enter(program.body, 0, 0, 0);
  }

  Program run(std::span<const Register> results) {
    for (const Register r : results) need_register(r);
    while (!pending_.empty()) {
      const std::uint32_t i = pending_.back();
      pending_.pop_back();
      need_place(node_of_[i]);
      const Instruction& instruction = program_.instructions[i];
      for_operands(instruction, [&](std::size_t k, char letter) {
        letter == 'a' ? need_array(instruction.operands[k]) : need_register(instruction.operands[k]);
      });
    }
    Program kept = program_;
    kept.instructions.clear();
    std::uint32_t place = 0;
    kept.body = keep(program_.body, kept.instructions, place);
    return kept;
  }

 private:
  struct Place {
    const Node* node = nullptr;
    std::uint32_t parent = 0;
    bool needed = false;
    std::vector<std::uint32_t> exits;  ///< of a loop or block: the nodes that leave or repeat it
  };

  void enter(const Sequence& sequence, std::uint32_t parent, std::uint32_t left, std::uint32_t repeated) {
    for (const Node& node : sequence) {
      const auto place = static_cast<std::uint32_t>(places_.size());
      places_.push_back({&node, parent, false, {}});
      if (node.kind == Node::Kind::run) list(node, place);
      if (node.kind == Node::Kind::leave) places_[left].exits.push_back(place);
      if (node.kind == Node::Kind::repeat) places_[repeated].exits.push_back(place);
      const bool is_loop = node.kind == Node::Kind::loop, catches = is_loop || node.kind == Node::Kind::block;
      enter(node.body, place, catches ? place : left, is_loop ? place : repeated);
      enter(node.other, place, catches ? place : left, is_loop ? place : repeated);
    }
  }

  void list(const Node& node, std::uint32_t place) {
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Instruction& instruction = program_.instructions[i];
      node_of_[i] = place;
      (is_store(instruction) ? stores_[instruction.operands[0]] : assignments_[instruction.result]).push_back(i);
    }
  }

  void need_instructions(const std::vector<std::uint32_t>& instructions) {
    for (const std::uint32_t i : instructions) {
      if (needed_[i]) continue;
      needed_[i] = true;
      pending_.push_back(i);
    }
  }

  void need_register(Register r) {
    if (r >= program_.register_count() || register_seen_[r]) return;
    register_seen_[r] = true;
    need_instructions(assignments_[r]);
  }

  void need_array(Register array) {
    if (array_seen_[array]) return;
    array_seen_[array] = true;
    need_instructions(stores_[array]);
  }

  void need_place(std::uint32_t place) {
    for (; !places_[place].needed; place = places_[place].parent) {
      places_[place].needed = true;
      if (places_[place].node->kind == Node::Kind::branch) need_register(places_[place].node->condition);
      for (const std::uint32_t exit : places_[place].exits) need_place(exit);
    }
  }

  Sequence keep(const Sequence& sequence, std::vector<Instruction>& instructions, std::uint32_t& place) const {
    Sequence kept;
    for (const Node& node : sequence) {
      const bool needed = places_[++place].needed;
      Node copy;
      copy.kind = node.kind;
      copy.condition = node.condition;
      copy.first = static_cast<std::uint32_t>(instructions.size());
      if (node.kind == Node::Kind::run) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          if (needed_[i]) instructions.push_back(program_.instructions[i]);
        }
        copy.count = static_cast<std::uint32_t>(instructions.size()) - copy.first;
      } else {
        copy.first = 0;
      }
      copy.body = keep(node.body, instructions, place);
      copy.other = keep(node.other, instructions, place);
      if (needed) kept.push_back(std::move(copy));
    }
    return kept;
  }

  const Program& program_;
  std::vector<Place> places_;
  std::vector<std::uint32_t> node_of_;
  std::vector<bool> needed_, register_seen_, array_seen_;
  std::vector<std::vector<std::uint32_t>> assignments_, stores_;
  std::vector<std::uint32_t> pending_;
};

}  // namespace

Program reaching(const Program& program, std::span<const Register> results) { return Reach(program).run(results); }

}  // namespace dmvv::compiler::snippet
