#include "compiler/snippet/tape.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <queue>

#include "compiler/snippet/device_functions.h"
#include "compiler/snippet/glsl_forms.h"
#include "shaders/records.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr std::uint32_t code_of_constant = 0;
constexpr std::uint32_t first_code_of_time = 1;  // by Type
constexpr std::uint32_t first_code_of_operation = 5;
constexpr std::uint32_t most_registers = 256;

/// Gives registers to the values of a line in one pass, and writes its instructions.
class Encoder {
 public:
  Encoder(const StraightLine& line, std::span<const Hoisted> hoisted,
          const std::function<std::uint32_t(const Step&)>& code)
      : steps_(line.steps), hoisted_(hoisted), code_(code), last_use_(steps_.size(), 0), register_(steps_.size(), 0) {}

  std::optional<Tape> run() {
    find_last_uses();
    for (std::uint32_t k = 0; k < steps_.size(); ++k) encode(k);
    const Step& result = steps_.back();
    if (result.kind == Step::Kind::point || result.kind == Step::Kind::constant) {
      encode_operation(
          {Step::Kind::operation, Type::real, Op::f_copy, {static_cast<std::uint32_t>(steps_.size()) - 1, 0, 0}},
          static_cast<std::uint32_t>(steps_.size()));
    }
    tape_.registers = next_;
    if (tape_.registers > most_registers) return std::nullopt;
    return std::move(tape_);
  }

 private:
  void find_last_uses() {
    for (std::uint32_t k = 0; k < steps_.size(); ++k) {
      for (std::uint32_t i = 0; i < operand_count(steps_[k]); ++i) last_use_[steps_[k].operands[i]] = k;
    }
  }

  std::uint32_t take_register() {
    if (free_.empty()) return next_++;
    const std::uint32_t r = free_.top();
    free_.pop();
    return r;
  }

  void encode(std::uint32_t k) {
    const Step& step = steps_[k];
    switch (step.kind) {
      case Step::Kind::point:
        register_[k] = step.operands[0];
        break;
      case Step::Kind::constant:
        break;  // stands in the instructions that use it
      case Step::Kind::hoisted:
        register_[k] = take_register();
        push(code_(step), register_[k], 0, 0, hoisted_[step.operands[0]].first_slot);
        break;
      case Step::Kind::operation:
        encode_operation(step, k);
        break;
    }
  }

  /// Operands that end here give their registers to the result.
  void encode_operation(const Step& step, std::uint32_t k) {
    const std::uint32_t count = operand_count(step);
    std::array<std::uint32_t, 3> operands{};
    std::vector<std::uint32_t> loaded;  // registers of constants that do not fit into the instruction
    std::optional<std::uint32_t> constant;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t operand = step.operands[i];
      operands[i] = register_[operand];
      if (steps_[operand].kind != Step::Kind::constant) continue;
      const std::uint32_t bits = steps_[operand].operands[0];
      if (count < 3 && (!constant || *constant == bits)) {
        constant = bits;
        operands[i] = DMVV_TAPE_CONSTANT;
      } else {
        loaded.push_back(take_register());
        operands[i] = loaded.back();
        push(code_of_constant, loaded.back(), 0, 0, bits);
      }
    }
    for (const std::uint32_t r : loaded) free_.push(r);
    for (std::uint32_t i = 0; i < count; ++i) release(step.operands[i], k);
    const std::uint32_t destination = take_register();
    if (k < steps_.size()) register_[k] = destination;
    push(code_(step), destination, operands[0], operands[1], count == 3 ? operands[2] : constant.value_or(0));
  }

  void release(std::uint32_t operand, std::uint32_t k) {
    const bool has_register =
        steps_[operand].kind == Step::Kind::operation || steps_[operand].kind == Step::Kind::hoisted;
    if (!has_register || last_use_[operand] != k) return;
    last_use_[operand] = ~0u;  // it may be an operand twice
    free_.push(register_[operand]);
  }

  void push(std::uint32_t code, std::uint32_t destination, std::uint32_t a, std::uint32_t b, std::uint32_t y) {
    tape_.instructions.emplace_back(code | destination << 8 | a << 16 | b << 24, y);
  }

  const std::vector<Step>& steps_;
  std::span<const Hoisted> hoisted_;
  const std::function<std::uint32_t(const Step&)>& code_;
  std::vector<std::uint32_t> last_use_, register_;
  std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>> free_;
  std::uint32_t next_ = DMVV_TAPE_FIRST_FREE;
  Tape tape_;
};

std::string operand_text(char letter, char name) {
  switch (letter) {
    case 'f':
      return fmt::format("uintBitsToFloat({})", name);
    case 'i':
      return fmt::format("int({})", name);
    case 'b':
      return fmt::format("({} != 0u)", name);
    default:
      return {name};
  }
}

std::string bits_text(char letter, const std::string& value) {
  if (letter == 'f') return fmt::format("floatBitsToUint({})", value);
  return letter == 'u' ? value : fmt::format("uint({})", value);
}

}  // namespace

std::string cannot_be_tape(const StraightLine& line, std::span<const Hoisted> hoisted) {
  for (const Step& step : line.steps) {
    if (step.kind == Step::Kind::operation && operation_text(step.op, {}, "").empty()) {
      return fmt::format("it uses {}", info(step.op).name);
    }
  }
  TapeCodes codes;
  codes.add(line);
  if (codes.encode(line, hoisted)) return "";
  return fmt::format("more than {} of its values wait at a time", most_registers);
}

void TapeCodes::add(const StraightLine& line) {
  operations_.push_back(Op::f_copy);
  for (const Step& step : line.steps) {
    if (step.kind == Step::Kind::operation) operations_.push_back(step.op);
    if (step.kind == Step::Kind::hoisted) time_values_[static_cast<std::size_t>(step.type)] = true;
  }
  std::ranges::sort(operations_);
  operations_.erase(std::unique(operations_.begin(), operations_.end()), operations_.end());
}

std::uint32_t TapeCodes::code(const Step& step) const {
  if (step.kind == Step::Kind::hoisted) return first_code_of_time + static_cast<std::uint32_t>(step.type);
  const auto place = std::ranges::lower_bound(operations_, step.op);
  return first_code_of_operation + static_cast<std::uint32_t>(place - operations_.begin());
}

std::optional<Tape> TapeCodes::encode(const StraightLine& line, std::span<const Hoisted> hoisted) const {
  return Encoder(line, hoisted, [this](const Step& step) { return code(step); }).run();
}

bool TapeCodes::has_third_operand() const {
  return std::ranges::any_of(operations_, [](Op op) { return info(op).operands.size() == 3; });
}

std::string TapeCodes::glsl() const {
  constexpr std::string_view prefix = "tape_";
  std::vector<Instruction> called;
  for (const Op op : operations_) called.push_back({op, 0, {}});
  std::string text = device_functions(called, prefix);
  text += "uint tape_operation(uint code, uint a, uint b, uint c, uint constant, uint first_time_value) {\n";
  text += fmt::format("  precise uint value = constant;  // {}\n", code_of_constant);
  for (std::uint32_t type = 0; type < time_values_.size(); ++type) {
    if (!time_values_[type]) continue;
    const std::string value = time_value_text(Type{static_cast<std::uint8_t>(type)}, "first_time_value + constant",
                                              "first_time_value + constant + 1u");
    text += fmt::format("  if (code == {}u) value = {};\n", first_code_of_time + type, bits_text("fiub"[type], value));
  }
  for (std::uint32_t k = 0; k < operations_.size(); ++k) {
    const OpInfo& table = info(operations_[k]);
    std::array<std::string, 3> operands;
    for (std::size_t i = 0; i < table.operands.size(); ++i) operands[i] = operand_text(table.operands[i], "abc"[i]);
    const std::string value = bits_text(table.result, operation_text(operations_[k], operands, prefix));
    text += fmt::format("  value = mix(value, {}, code == {}u);\n", value, first_code_of_operation + k);
  }
  return text + "  return value;\n}\n\n";
}

}  // namespace dmvv::compiler::snippet
