// Definite assignment as a forward data flow over the blocks of each function: a part of a variable is set at the
// beginning of a block if it is set at the end of all blocks before it. Only parts that some block reads before it sets
// them take part; within a block a walk suffices.
#include "compiler/snippet/unset_variables.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <glslang/SPIRV/spirv.hpp>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

namespace dmvv::compiler::snippet {
namespace {

using Word = std::uint32_t;
constexpr std::size_t header_words = 5;
constexpr std::uint32_t most_parts = 256;                // of a variable; a larger one counts as one part
constexpr std::size_t most_flow = std::size_t{1} << 31;  // parts times blocks

struct Instruction {
  spv::Op op = spv::OpNop;
  std::span<const Word> operands;  ///< type and result among them
  std::size_t at = 0;              ///< word of the module where it begins
  std::uint32_t line = 0;
};

/// Calls visit(instruction) for each of a module that glslang made.
template <class Visit>
void for_each_instruction(std::span<const Word> words, const Visit& visit) {
  std::uint32_t line = 0;
  for (std::size_t at = header_words; at < words.size();) {
    const std::size_t length = words[at] >> 16;
    if (length == 0 || at + length > words.size()) return;
    const Instruction instruction{static_cast<spv::Op>(words[at] & 0xffffu), words.subspan(at + 1, length - 1), at,
                                  line};
    if (instruction.op == spv::OpLine) line = instruction.operands[1];
    visit(instruction);
    at += length;
  }
}

struct Block {
  Word label = 0;
  std::vector<Instruction> body;  ///< its terminator is the last
};

struct Function {
  Word id = 0;
  std::vector<Word> parameters;
  std::vector<Block> blocks;  ///< the first one is entered
};

/// What is needed of a module.
struct Module {
  std::map<Word, std::string> names;
  std::unordered_map<Word, Instruction> types;      ///< and the constants
  std::unordered_map<Word, Instruction> variables;  ///< of functions and global ones
  std::map<Word, Function> functions;
  std::unordered_map<Word, Word> bases;  ///< of access chains: the pointer they begin with
  std::unordered_map<Word, Word> parameter_types;
  Word entry = 0;

  explicit Module(std::span<const Word> words) {
    Function* function = nullptr;
    for_each_instruction(words, [&](const Instruction& instruction) { read(instruction, function); });
  }

 private:
  void read(const Instruction& instruction, Function*& function) {
    const auto& operands = instruction.operands;
    switch (instruction.op) {
      case spv::OpEntryPoint:
        entry = operands[1];
        break;
      case spv::OpName:
        names[operands[0]] = reinterpret_cast<const char*>(&operands[1]);
        break;
      case spv::OpFunction:
        function = &functions[operands[1]];
        function->id = operands[1];
        break;
      case spv::OpFunctionParameter:
        function->parameters.push_back(operands[1]);
        parameter_types[operands[1]] = operands[0];
        break;
      case spv::OpFunctionEnd:
        function = nullptr;
        break;
      case spv::OpVariable:
        variables[operands[1]] = instruction;
        break;
      case spv::OpLabel:
        function->blocks.push_back({operands[0], {}});
        break;
      default:
        if (instruction.op == spv::OpAccessChain) bases[operands[1]] = operands[2];
        if (function != nullptr && !function->blocks.empty()) {
          if (instruction.op != spv::OpLine && instruction.op != spv::OpNoLine) {
            function->blocks.back().body.push_back(instruction);
          }
        } else if (instruction.op >= spv::OpTypeVoid && instruction.op <= spv::OpTypePointer) {
          types[operands[0]] = instruction;
        } else if (instruction.op == spv::OpConstant) {
          types[operands[1]] = instruction;
        }
    }
  }

 public:
  Word base_of(Word pointer) const {
    for (auto base = bases.find(pointer); base != bases.end(); base = bases.find(pointer)) pointer = base->second;
    return pointer;
  }

  /// The type that a variable or parameter holds; 0 if it is no pointer.
  Word held_by(Word pointer) const {
    const auto variable = variables.find(pointer);
    const auto parameter = parameter_types.find(pointer);
    const Word type = variable != variables.end()          ? variable->second.operands[0]
                      : parameter != parameter_types.end() ? parameter->second
                                                           : 0;
    const auto known = types.find(type);
    return known != types.end() && known->second.op == spv::OpTypePointer ? known->second.operands[2] : 0;
  }

  std::uint32_t member_count(const Instruction& type) const {
    if (type.op == spv::OpTypeStruct) return static_cast<std::uint32_t>(type.operands.size()) - 1;
    if (type.op == spv::OpTypeArray) return types.at(type.operands[2]).operands[2];
    return type.op == spv::OpTypeVector || type.op == spv::OpTypeMatrix ? type.operands[2] : 0;
  }
  static Word member_type(const Instruction& type, std::uint32_t i) {
    return type.op == spv::OpTypeStruct ? type.operands[1 + i] : type.operands[1];
  }

  /// Scalars in a value, counted up to most_parts + 1.
  std::uint32_t parts(Word type_id) const {
    const auto type = types.find(type_id);
    if (type == types.end()) return 1;
    const std::uint32_t count = member_count(type->second);
    if (count == 0) return 1;
    if (type->second.op != spv::OpTypeStruct) {
      return std::min(std::min(count, most_parts + 1) * parts(member_type(type->second, 0)), most_parts + 1);
    }
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i < count && sum <= most_parts; ++i) sum += parts(member_type(type->second, i));
    return std::min(sum, most_parts + 1);
  }
};

/// Functions that the entry point calls, and what it takes from the calls.
struct Calls {
  std::set<Word> reached;
  std::set<Word> out_parameters;  ///< pointers that no caller sets before the call

  explicit Calls(const Module& module) {
    std::set<Word> stored;  // variables that something is stored in
    for (const auto& [id, function] : module.functions) {
      for (const Block& block : function.blocks) {
        for (const Instruction& instruction : block.body) {
          if (instruction.op == spv::OpStore) stored.insert(module.base_of(instruction.operands[0]));
        }
      }
    }
    std::vector<Word> open = {module.entry};
    std::set<Word> set_before;
    while (!open.empty()) {
      const Word id = open.back();
      open.pop_back();
      const auto function = module.functions.find(id);
      if (function == module.functions.end() || !reached.insert(id).second) continue;
      for (const Block& block : function->second.blocks) {
        for (const Instruction& call : block.body) {
          if (call.op != spv::OpFunctionCall) continue;
          open.push_back(call.operands[2]);
          const auto callee = module.functions.find(call.operands[2]);
          if (callee == module.functions.end()) continue;
          for (std::size_t i = 0; i < callee->second.parameters.size() && 3 + i < call.operands.size(); ++i) {
            const Word parameter = callee->second.parameters[i];
            if (module.held_by(parameter) == 0) continue;
            (stored.contains(call.operands[3 + i]) ? set_before : out_parameters).insert(parameter);
          }
        }
      }
    }
    for (const Word parameter : set_before) out_parameters.erase(parameter);
  }
};

/// Parts [first, first + count) of the variables of a function; `exact` if all of them are meant, and not one of them.
struct Range {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  bool exact = true;
};

/// One function's blocks, what they read and set, and what comes through to them.
class Flow {
 public:
  Flow(const Module& module, const Function& function, const Calls& calls, std::vector<UnsetVariable>& found)
      : module_(module), function_(function), calls_(calls), found_(found) {}

  void run() {
    list_variables();
    if (variables_.empty()) return;
    find_exposed();
    if (exposed_.empty() || exposed_.size() * function_.blocks.size() > most_flow) return;
    solve();
    for (std::size_t b = 0; b < function_.blocks.size(); ++b) report(b);
  }

 private:
  using Bits = std::vector<std::uint64_t>;
  static constexpr std::uint32_t nowhere = ~0u;

  // ---- variables and the parts that pointers mean ----

  void list_variables() {
    for (const Word id : function_.parameters) {
      if (calls_.out_parameters.contains(id)) add_variable(id);
    }
    for (const Block& block : function_.blocks) {
      for (const Instruction& instruction : block.body) note_pointer(instruction);
    }
  }

  void add_variable(Word id) {
    const auto variable = module_.variables.find(id);
    if (variable != module_.variables.end() && variable->second.operands.size() > 3) return;  // has a value
    const Word type = module_.held_by(id);
    if (type == 0 || pointers_.contains(id)) return;
    const std::uint32_t parts = module_.parts(type);
    pointers_[id] = {{part_count_, parts > most_parts ? 1 : parts, true}, type};
    variables_.push_back(id);
    first_part_.push_back(part_count_);
    part_count_ += parts > most_parts ? 1 : parts;
  }

  void note_pointer(const Instruction& instruction) {
    for (const Word operand : instruction.operands) {  // OpVariable stands in the module's list
      const auto variable = module_.variables.find(operand);
      const bool is_local = variable != module_.variables.end() && variable->second.operands[1] == operand &&
                            variable->second.operands[2] == spv::StorageClassFunction;
      if (is_local) add_variable(operand);
    }
    if (instruction.op != spv::OpAccessChain) return;
    const auto base = pointers_.find(instruction.operands[2]);
    if (base == pointers_.end()) return;
    Pointer pointer = base->second;
    for (const Word index : instruction.operands.subspan(3)) step(pointer, index);
    pointers_[instruction.operands[1]] = pointer;
  }

  struct Pointer {
    Range range;
    Word type = 0;
  };

  void step(Pointer& pointer, Word index_id) const {
    const Instruction& type = module_.types.at(pointer.type);
    const auto index = module_.types.find(index_id);
    const std::uint32_t count = module_.member_count(type);
    const bool is_known = index != module_.types.end() && index->second.op == spv::OpConstant;
    const std::uint32_t i = is_known && count != 0 ? std::min(index->second.operands[2], count - 1) : 0;
    const std::uint32_t whole = module_.parts(pointer.type);
    pointer.type = Module::member_type(type, i);
    if (pointer.range.count != whole) {  // counts as one, or one of several is meant already
      pointer.range.exact = pointer.range.exact && pointer.range.count == 1;
      return;
    }
    if (!is_known) {
      pointer.range.exact = false;
      return;
    }
    for (std::uint32_t k = 0; k < i; ++k) pointer.range.first += module_.parts(Module::member_type(type, k));
    pointer.range.count = module_.parts(pointer.type);
  }

  // ---- what an instruction reads and sets ----

  template <class Read, class Set>
  void visit(const Instruction& instruction, const Read& read, const Set& set) const {
    const auto& operands = instruction.operands;
    const auto at = [&](Word pointer, const auto& use) {
      if (const auto known = pointers_.find(pointer); known != pointers_.end()) use(known->second.range);
    };
    switch (instruction.op) {
      case spv::OpLoad:
        return at(operands[2], read);
      case spv::OpStore:
        return at(operands[0], set);
      case spv::OpCopyMemory:
        at(operands[1], read);
        return at(operands[0], set);
      case spv::OpFunctionCall:
        for (const Word argument : operands.subspan(3)) at(argument, set);
        return;
      case spv::OpExtInst:  // modf, frexp
        for (const Word argument : operands.subspan(4)) at(argument, set);
        return;
      case spv::OpReturn:
      case spv::OpReturnValue:
        for (const Word parameter : function_.parameters) {
          if (calls_.out_parameters.contains(parameter)) at(parameter, read);
        }
        return;
      default:
        return;
    }
  }

  void find_exposed() {
    std::vector<std::size_t> set_in(part_count_, ~std::size_t{0});
    index_.assign(part_count_, nowhere);
    for (std::size_t b = 0; b < function_.blocks.size(); ++b) {
      for (const Instruction& instruction : function_.blocks[b].body) {
        visit(
            instruction,
            [&](const Range& range) {
              for (std::uint32_t k = range.first; k < range.first + range.count; ++k) {
                if (set_in[k] == b || index_[k] != nowhere) continue;
                index_[k] = static_cast<std::uint32_t>(exposed_.size());
                exposed_.push_back(k);
              }
            },
            [&](const Range& range) { std::fill_n(set_in.begin() + range.first, range.count, b); });
      }
    }
  }

  void set_bits(Bits& bits, const Range& range) const {
    for (std::uint32_t k = range.first; k < range.first + range.count; ++k) {
      if (index_[k] != nowhere) bits[index_[k] / 64] |= std::uint64_t{1} << index_[k] % 64;
    }
  }
  bool is_set(const Bits& bits, std::uint32_t part) const {
    return index_[part] == nowhere || (bits[index_[part] / 64] >> index_[part] % 64 & 1u) != 0;
  }

  // ---- the data flow ----

  std::vector<std::size_t> next_of(const Block& block) const {
    std::vector<std::size_t> next;
    if (block.body.empty()) return next;
    const Instruction& last = block.body.back();
    const auto add = [&](Word label) {
      if (const auto known = numbers_.find(label); known != numbers_.end()) next.push_back(known->second);
    };
    if (last.op == spv::OpBranch) add(last.operands[0]);
    if (last.op == spv::OpBranchConditional) add(last.operands[1]), add(last.operands[2]);
    if (last.op == spv::OpSwitch) {
      for (std::size_t i = 1; i < last.operands.size(); i += 2) add(last.operands[i]);
    }
    return next;
  }

  /// set_at_[b]: what is set where block b begins, whatever way is taken. Blocks that nothing reaches have all set.
  void solve() {
    const std::size_t words = (exposed_.size() + 63) / 64, blocks = function_.blocks.size();
    for (std::size_t b = 0; b < blocks; ++b) numbers_[function_.blocks[b].label] = b;
    set_at_.assign(blocks, Bits(words, ~std::uint64_t{0}));
    set_at_[0].assign(words, 0);
    std::vector<Bits> sets(blocks, Bits(words, 0));
    std::vector<std::vector<std::size_t>> next(blocks);
    for (std::size_t b = 0; b < blocks; ++b) {
      for (const Instruction& instruction : function_.blocks[b].body) {
        visit(
            instruction, [](const Range&) {}, [&](const Range& range) { set_bits(sets[b], range); });
      }
      next[b] = next_of(function_.blocks[b]);
    }
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t b = 0; b < blocks; ++b) {
        for (const std::size_t to : next[b]) {
          for (std::size_t w = 0; w < words; ++w) {
            const std::uint64_t before = set_at_[to][w];
            set_at_[to][w] &= set_at_[b][w] | sets[b][w];
            changed |= set_at_[to][w] != before;
          }
        }
      }
    }
  }

  void report(std::size_t b) {
    Bits set = set_at_[b];
    for (const Instruction& instruction : function_.blocks[b].body) {
      visit(
          instruction,
          [&](const Range& range) {
            std::uint32_t unset = 0;
            for (std::uint32_t k = range.first; k < range.first + range.count; ++k) unset += is_set(set, k) ? 0 : 1;
            if (unset == 0 || (!range.exact && unset < range.count)) return;
            const auto after = std::upper_bound(first_part_.begin(), first_part_.end(), range.first);
            add(variables_[static_cast<std::size_t>(after - first_part_.begin()) - 1], instruction.line);
          },
          [&](const Range& range) { set_bits(set, range); });
    }
  }

  void add(Word id, std::uint32_t line) {
    const bool is_known = std::ranges::any_of(found_, [id](const UnsetVariable& other) { return other.id == id; });
    const auto name = module_.names.find(id);
    if (is_known || name == module_.names.end()) return;
    found_.push_back({id, name->second, line, module_.parameter_types.contains(id)});
  }

  const Module& module_;
  const Function& function_;
  const Calls& calls_;
  std::vector<UnsetVariable>& found_;
  std::unordered_map<Word, Pointer> pointers_;
  std::vector<Word> variables_;
  std::vector<std::uint32_t> first_part_;  ///< parallel to variables_
  std::uint32_t part_count_ = 0;
  std::vector<std::uint32_t> exposed_;             ///< parts
  std::vector<std::uint32_t> index_;               ///< of a part among the exposed ones, or nowhere
  std::unordered_map<Word, std::size_t> numbers_;  ///< of blocks
  std::vector<Bits> set_at_;
};

/// Global variables without a value that are read: what the calls set is not followed, the entry point's own stores
/// are.
void find_unset_globals(const Module& module, const Calls& calls, std::vector<UnsetVariable>& found) {
  std::set<Word> unset;
  for (const auto& [id, variable] : module.variables) {
    if (variable.operands[2] == spv::StorageClassPrivate && variable.operands.size() == 3) unset.insert(id);
  }
  if (unset.empty()) return;
  for (const Block& block : module.functions.at(module.entry).blocks) {
    for (const Instruction& instruction : block.body) {
      if (instruction.op == spv::OpStore) unset.erase(instruction.operands[0]);
    }
  }
  for (const Word function : calls.reached) {
    for (const Block& block : module.functions.at(function).blocks) {
      for (const Instruction& instruction : block.body) {
        if (instruction.op != spv::OpLoad) continue;
        const Word id = module.base_of(instruction.operands[2]);
        const auto name = module.names.find(id);
        if (unset.erase(id) == 0 || name == module.names.end()) continue;
        found.push_back({id, name->second, instruction.line, false});
      }
    }
  }
}

// ---- other values ----

/// Writes constants behind all others of a module.
class ConstantWriter {
 public:
  ConstantWriter(const Module& module, Word first_id, float value)
      : module_(module), next_id_(first_id), value_(value) {}

  Word constant(Word type_id) {
    const auto [known, is_new] = known_.try_emplace(type_id, 0);
    if (!is_new) return known->second;
    const Instruction& type = module_.types.at(type_id);
    std::vector<Word> operands = {type_id, 0};
    spv::Op op = spv::OpConstant;
    switch (type.op) {
      case spv::OpTypeBool:
        op = value_ != 0.0f ? spv::OpConstantTrue : spv::OpConstantFalse;
        break;
      case spv::OpTypeFloat:
        operands.push_back(std::bit_cast<Word>(value_));
        break;
      case spv::OpTypeInt:
        operands.push_back(static_cast<Word>(static_cast<std::int32_t>(value_)));
        break;
      default:
        op = spv::OpConstantComposite;
        for (std::uint32_t i = 0; i < module_.member_count(type); ++i) {
          operands.push_back(constant(Module::member_type(type, i)));
        }
    }
    operands[1] = next_id_++;
    words.push_back(static_cast<Word>(operands.size() + 1) << 16 | static_cast<Word>(op));
    words.insert(words.end(), operands.begin(), operands.end());
    return known_[type_id] = operands[1];
  }

  Word next_id() const { return next_id_; }
  std::vector<Word> words;

 private:
  const Module& module_;
  std::map<Word, Word> known_;  // by type
  Word next_id_;
  float value_;
};

}  // namespace

std::vector<UnsetVariable> find_unset_variables(std::span<const std::uint32_t> spirv) {
  const Module module(spirv);
  const Calls calls(module);
  std::vector<UnsetVariable> found;
  for (const Word function : calls.reached) Flow(module, module.functions.at(function), calls, found).run();
  find_unset_globals(module, calls, found);
  return found;
}

std::vector<std::uint32_t> with_values(std::span<const std::uint32_t> spirv, std::span<const std::uint32_t> variables,
                                       float value) {
  const Module module(spirv);
  ConstantWriter constants(module, spirv[3], value);
  std::map<Word, std::vector<Word>> stores;  // by function; 0: a global variable's
  std::map<Word, Word> owners;
  for (const auto& [id, function] : module.functions) {
    for (const Word parameter : function.parameters) owners[parameter] = id;
  }
  Word function = 0;
  for_each_instruction(spirv, [&](const Instruction& instruction) {
    if (instruction.op == spv::OpFunction) function = instruction.operands[1];
    if (instruction.op == spv::OpFunctionEnd) function = 0;
    if (instruction.op == spv::OpVariable) owners[instruction.operands[1]] = function;
  });
  for (const Word id : variables) {
    const Word owner = owners.at(id) != 0 ? owners.at(id) : module.entry;
    std::vector<Word>& words = stores[owner];
    words.insert(words.end(), {3u << 16 | spv::OpStore, id, constants.constant(module.held_by(id))});
  }

  std::vector<Word> out(spirv.begin(), spirv.begin() + header_words);
  bool in_functions = false, at_start = false;  // at_start: of a function's first block, where its variables stand
  std::size_t from = header_words;
  const auto copy_up_to = [&](std::size_t at) {
    out.insert(out.end(), spirv.begin() + static_cast<std::ptrdiff_t>(from),
               spirv.begin() + static_cast<std::ptrdiff_t>(at));
    from = at;
  };
  for_each_instruction(spirv, [&](const Instruction& instruction) {
    if (instruction.op == spv::OpFunction && !in_functions) {
      copy_up_to(instruction.at);
      out.insert(out.end(), constants.words.begin(), constants.words.end());
      in_functions = true;
    }
    if (instruction.op == spv::OpFunction) {
      function = instruction.operands[1];
      at_start = true;
    }
    const bool before_body = instruction.op == spv::OpFunction || instruction.op == spv::OpFunctionParameter ||
                             instruction.op == spv::OpLabel || instruction.op == spv::OpVariable ||
                             instruction.op == spv::OpLine || instruction.op == spv::OpNoLine;
    if (!at_start || !in_functions || before_body) return;
    copy_up_to(instruction.at);
    out.insert(out.end(), stores[function].begin(), stores[function].end());
    at_start = false;
  });
  copy_up_to(spirv.size());
  out[3] = constants.next_id();
  return out;
}

}  // namespace dmvv::compiler::snippet
