// Executing single instructions over any domain of numbers: cells, and the dispatch made from ops.def.
//
// A domain gives the types Real and Integer (bool is an Integer) and one static function an operation, named like it.
// An operation without its function does not compile.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "compiler/snippet/operands.h"
#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

template <class Domain>
struct Cell {
  typename Domain::Real f{};
  typename Domain::Integer i{};
};

/// A literal as a template argument.
template <std::size_t n>
struct Letters {
  char text[n];
  constexpr Letters(const char (&letters)[n]) { std::copy_n(letters, n, text); }  // NOLINT: implicit on purpose
  static constexpr std::size_t count = n - 1;
};

template <class Domain, char letter>
auto get(const Cell<Domain>& cell) {
  if constexpr (letter == 'f') return cell.f;
  if constexpr (letter == 'i') return static_cast<typename Domain::Signed>(cell.i);
  if constexpr (letter == 'u') return static_cast<typename Domain::Unsigned>(cell.i);
  if constexpr (letter == 'b') return static_cast<typename Domain::Boolean>(cell.i);
}

template <class Domain, char letter, class Value>
void set(Cell<Domain>& cell, const Value& value) {
  if constexpr (letter == 'f') {
    cell.f = value;
  } else {
    cell.i = static_cast<typename Domain::Integer>(value);
  }
}

/// Executes everything but loads and stores of arrays.
template <class Domain>
void execute(const Instruction& instruction, Cell<Domain>* cells) {
  const auto apply = [&]<Letters result, Letters operands>(const auto& function) {
    const auto operand = [&]<std::size_t i>() { return get<Domain, operands.text[i]>(cells[instruction.operands[i]]); };
    Cell<Domain>& out = cells[instruction.result];
    constexpr char letter = result.text[0];
    if constexpr (operands.count == 1) {
      set<Domain, letter>(out, function(operand.template operator()<0>()));
    } else if constexpr (operands.count == 2) {
      set<Domain, letter>(out, function(operand.template operator()<0>(), operand.template operator()<1>()));
    } else {
      set<Domain, letter>(out, function(operand.template operator()<0>(), operand.template operator()<1>(),
                                        operand.template operator()<2>()));
    }
  };
  switch (instruction.op) {
#define DMVV_OP(name, result, operands)                                                                  \
  case Op::name:                                                                                         \
    if constexpr (operands[0] != 'a') {                                                                  \
      apply.template operator()<#result, operands>([](const auto&... x) { return Domain::name(x...); }); \
    }                                                                                                    \
    break;
#include "compiler/snippet/ops.def"
#undef DMVV_OP
  }
}

inline bool is_copy(Op op) { return op >= Op::f_copy && op <= Op::b_copy; }
inline bool is_choice(Op op) { return op >= Op::f_select && op <= Op::b_select; }
inline bool is_load(Op op) { return op >= Op::f_load && op <= Op::b_load; }

/// Where each array begins in one run of cells; one entry more than there are arrays.
inline std::vector<std::size_t> array_starts(const Program& program) {
  std::vector<std::size_t> starts{0};
  for (const Array& array : program.arrays) starts.push_back(starts.back() + array.size);
  return starts;
}

}  // namespace dmvv::compiler::snippet
