#include "compiler/snippet/spirv_module.h"

#include <fmt/format.h>
#include <spirv-tools/libspirv.h>

#include <cstring>
#define SPV_ENABLE_UTILITY_CODE
#include <glslang/SPIRV/spirv.hpp>

namespace dmvv::compiler::snippet {

namespace {

constexpr std::uint32_t max_scalars = 1u << 16;  ///< in one value

/// Calls visit(opcode, words) for each instruction; false if the words are cut short.
template <class Visit>
bool for_each_instruction(std::span<const std::uint32_t> words, const Visit& visit) {
  if (words.size() < 5 || words[0] != spv::MagicNumber) return false;
  for (std::size_t at = 5; at < words.size();) {
    const std::size_t length = words[at] >> 16;
    if (length == 0 || at + length > words.size()) return false;
    if (!visit(static_cast<std::uint16_t>(words[at] & 0xffffu), words.subspan(at + 1, length - 1))) return true;
    at += length;
  }
  return true;
}

SpirvInstruction decode(std::uint16_t opcode, std::span<const std::uint32_t> words) {
  bool has_result = false;
  bool has_type = false;
  spv::HasResultAndType(static_cast<spv::Op>(opcode), &has_result, &has_type);
  SpirvInstruction instruction{.opcode = opcode, .operands = words};
  const auto take = [&] {
    const SpirvId id = instruction.operands.empty() ? 0 : instruction.operands.front();
    if (!instruction.operands.empty()) instruction.operands = instruction.operands.subspan(1);
    return id;
  };
  if (has_type) instruction.type = take();
  if (has_result) instruction.result = take();
  return instruction;
}

std::string string_of(std::span<const std::uint32_t> words) {
  std::string text(words.size() * sizeof(std::uint32_t), '\0');
  std::memcpy(text.data(), words.data(), text.size());
  return text.substr(0, text.find('\0'));
}

/// "wobble" of glslang's "wobble(vf3;f1;".
std::string plain_name(const std::string& mangled) { return mangled.substr(0, mangled.find('(')); }

class Parser {
 public:
  explicit Parser(std::span<const std::uint32_t> words) : words_(words) {}

  Result<SpirvModule> run() {
    const bool whole = for_each_instruction(words_, [&](std::uint16_t opcode, std::span<const std::uint32_t> words) {
      read(decode(opcode, words));
      return error_.empty();
    });
    if (!whole) return fail(Fault::input, "the SPIR-V is cut short");
    if (!error_.empty()) return fail(Fault::input, error_);
    if (module_.first_block == 0) return fail(Fault::input, "the SPIR-V has no entry point");
    return std::move(module_);
  }

 private:
  void read(const SpirvInstruction& instruction) {
    switch (instruction.opcode) {
      case spv::OpExtInstImport:
        if (string_of(instruction.operands) == "GLSL.std.450") module_.glsl_instructions = instruction.result;
        break;
      case spv::OpEntryPoint:
        if (entry_ == 0) entry_ = instruction.operands[1];
        break;
      case spv::OpDecorate:
        if (instruction.operands[1] == spv::DecorationLocation) {
          module_.locations[instruction.operands[0]] = instruction.operands[2];
        }
        break;
      case spv::OpFunction:
        in_entry_ = instruction.result == entry_;
        break;
      case spv::OpFunctionEnd:
        in_entry_ = false;
        break;
      default:
        if (in_entry_) {
          read_in_function(instruction);
        } else if (instruction.result != 0 && block_ == nullptr) {
          read_global(instruction);
        }
    }
  }

  void read_global(const SpirvInstruction& instruction) {
    if (instruction.opcode >= spv::OpTypeVoid && instruction.opcode <= spv::OpTypeForwardPointer) {
      read_type(instruction);
    } else {
      module_.definitions[instruction.result] = instruction;
    }
  }

  void read_in_function(const SpirvInstruction& instruction) {
    if (instruction.opcode == spv::OpLabel) {
      block_ = &module_.blocks[instruction.result];
      if (module_.first_block == 0) module_.first_block = instruction.result;
    } else if (block_ == nullptr || instruction.opcode == spv::OpLine || instruction.opcode == spv::OpNoLine) {
      return;
    } else if (instruction.opcode == spv::OpVariable) {
      module_.locals.push_back(instruction);
    } else if (instruction.opcode == spv::OpPhi) {
      block_->phis.push_back(instruction);
    } else if (instruction.opcode == spv::OpSelectionMerge || instruction.opcode == spv::OpLoopMerge) {
      block_->merge = instruction;
    } else if ((instruction.opcode >= spv::OpBranch && instruction.opcode <= spv::OpUnreachable) ||
               instruction.opcode == spv::OpTerminateInvocation) {
      block_->terminator = instruction;
    } else {
      block_->body.push_back(instruction);
    }
  }

  void read_type(const SpirvInstruction& instruction) {
    SpirvType type;
    const auto& operands = instruction.operands;
    switch (instruction.opcode) {
      case spv::OpTypeBool:
        type = scalar(Type::boolean);
        break;
      case spv::OpTypeInt:
        type = scalar(operands[1] != 0 ? Type::integer : Type::unsigned_integer);
        if (operands[0] != 32)
          error_ = fmt::format("integers of {} bits are not known here; use int or uint", operands[0]);
        break;
      case spv::OpTypeFloat:
        type = scalar(Type::real);
        if (operands[0] != 32) error_ = fmt::format("floats of {} bits are not known here; use float", operands[0]);
        break;
      case spv::OpTypeVector:
        type = repeated(SpirvType::Kind::vector, operands[0], operands[1]);
        break;
      case spv::OpTypeMatrix:
        type = repeated(SpirvType::Kind::matrix, operands[0], operands[1]);
        break;
      case spv::OpTypeArray:
        type = repeated(SpirvType::Kind::array, operands[0], length_of(operands[1]));
        break;
      case spv::OpTypeStruct:
        type = structure(operands);
        break;
      case spv::OpTypePointer:
        type.kind = SpirvType::Kind::pointer;
        type.members = {operands[1]};
        break;
      default:
        break;  // void, function; whatever else there is, its use is refused
    }
    module_.types[instruction.result] = std::move(type);
  }

  static SpirvType scalar(Type type) { return {.kind = SpirvType::Kind::scalar, .scalar = type, .members = {}}; }

  std::uint32_t length_of(SpirvId constant) const {
    const auto place = module_.definitions.find(constant);
    return place == module_.definitions.end() || place->second.operands.empty() ? 0 : place->second.operands[0];
  }

  SpirvType repeated(SpirvType::Kind kind, SpirvId member, std::uint32_t count) {
    const SpirvType& element = module_.types[member];
    const std::uint64_t size = std::uint64_t{element.size} * count;
    if (count == 0 || size > max_scalars) {
      error_ = fmt::format("an array of {} elements is more than a snippet may hold ({} scalars)", count, max_scalars);
      return {};
    }
    return {.kind = kind,
            .scalar = element.scalar,
            .members = {member},
            .count = count,
            .size = static_cast<std::uint32_t>(size),
            .leaves = kind == SpirvType::Kind::array ? element.leaves : element.leaves * count};
  }

  SpirvType structure(std::span<const std::uint32_t> members) {
    SpirvType type{.kind = SpirvType::Kind::structure,
                   .members = {members.begin(), members.end()},
                   .count = static_cast<std::uint32_t>(members.size()),
                   .size = 0,
                   .leaves = 0};
    for (const SpirvId member : members) {
      type.size += module_.types[member].size;
      type.leaves += module_.types[member].leaves;
      if (type.size > max_scalars) error_ = fmt::format("a struct holds more than {} scalars", max_scalars);
    }
    return type;
  }

  std::span<const std::uint32_t> words_;
  SpirvModule module_;
  std::string error_;
  SpirvId entry_ = 0;
  bool in_entry_ = false;
  SpirvBlock* block_ = nullptr;
};

struct CallGraph {
  struct Function {
    std::string name = "a function";
    std::uint64_t own = 0;
    std::vector<SpirvId> calls;
    enum class State : std::uint8_t { unseen, open, done } state = State::unseen;
    std::uint64_t inlined = 0;
  };
  std::map<SpirvId, Function> functions;
};

/// Depth first; glslang limits neither calls nor depth, so the chain is bounded here.
Result<std::uint64_t> inlined_size(CallGraph& graph, SpirvId id, std::uint64_t limit, std::size_t depth) {
  auto& function = graph.functions[id];
  using State = CallGraph::Function::State;
  if (function.state == State::done) return function.inlined;
  if (function.state == State::open) {
    return fail(Fault::input, fmt::format("recursion: '{}' calls itself", function.name));
  }
  if (depth > 200) return fail(Fault::input, fmt::format("calls are nested too deep at '{}' (200)", function.name));
  function.state = State::open;
  function.inlined = function.own;
  for (const SpirvId callee : function.calls) {
    const auto size = inlined_size(graph, callee, limit, depth + 1);
    if (!size) return size;
    function.inlined += *size;
    if (function.inlined > limit) {
      return fail(Fault::input,
                  fmt::format("'{}' grows beyond {} instructions when its calls are inlined", function.name, limit));
    }
  }
  function.state = State::done;
  return function.inlined;
}

}  // namespace

Result<SpirvModule> parse_spirv(std::span<const std::uint32_t> words) { return Parser(words).run(); }

Result<void> check_calls(std::span<const std::uint32_t> words, std::uint64_t limit) {
  CallGraph graph;
  std::map<SpirvId, std::string> names;
  CallGraph::Function* current = nullptr;
  const bool whole = for_each_instruction(words, [&](std::uint16_t opcode, std::span<const std::uint32_t> raw) {
    const SpirvInstruction instruction = decode(opcode, raw);
    if (opcode == spv::OpName && !raw.empty()) names[raw[0]] = plain_name(string_of(raw.subspan(1)));
    if (opcode == spv::OpFunction) {
      current = &graph.functions[instruction.result];
      if (names.contains(instruction.result)) current->name = names[instruction.result];
    }
    if (current != nullptr) ++current->own;
    if (current != nullptr && opcode == spv::OpFunctionCall && !instruction.operands.empty())
      current->calls.push_back(instruction.operands[0]);
    return true;
  });
  if (!whole) return fail(Fault::input, "the SPIR-V is cut short");
  for (auto& [id, function] : graph.functions) {
    const auto size = inlined_size(graph, id, limit, 0);
    if (!size) return tl::unexpected<Error>(size.error());
  }
  return {};
}

std::string opcode_name(std::uint16_t opcode) { return std::string("Op") + spvOpcodeString(opcode); }

}  // namespace dmvv::compiler::snippet
