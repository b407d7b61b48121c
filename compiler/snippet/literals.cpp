#include "compiler/snippet/literals.h"

#include <fmt/format.h>
#include <spirv-tools/libspirv.h>

#include <bit>
#include <charconv>
#include <glslang/SPIRV/spirv.hpp>
#include <memory>
#include <span>

namespace dmvv::compiler::snippet {
namespace {

using Word = std::uint32_t;
constexpr std::string_view array_name = "dmvv_literals";
/// Elements along each of the array's three dimensions: few different indices, and no more scalars than a value may
/// have.
constexpr std::size_t edge = 40;
constexpr std::size_t most = edge * edge * edge;

/// What of a module stands for the array, and what is put in its place.
class Restorer {
 public:
  Restorer(std::span<const Word> words, std::span<const float> values) : words_(words), values_(values) {}

  std::vector<Word> run() {
    find_array();
    if (array_ == 0) return {words_.begin(), words_.end()};
    next_id_ = words_[3];
    first_constant_ = next_id_;
    next_id_ += static_cast<Word>(values_.size());
    const std::unique_ptr<spv_context_t, decltype(&spvContextDestroy)> context(spvContextCreate(SPV_ENV_VULKAN_1_2),
                                                                               spvContextDestroy);
    out_.assign(words_.begin(), words_.begin() + 5);
    out_[3] = next_id_;
    const auto copy = [](void* self, const spv_parsed_instruction_t* instruction) {
      static_cast<Restorer*>(self)->copy(*instruction);
      return SPV_SUCCESS;
    };
    spvBinaryParse(context.get(), this, words_.data(), words_.size(), nullptr, copy, nullptr);
    return std::move(out_);
  }

 private:
  /// The array, its elements' pointers, and what is loaded from them.
  void find_array() {
    std::unordered_map<Word, Word> integers, pointers;
    for (std::size_t at = 5; at < words_.size(); at += words_[at] >> 16) {
      const Word* operands = &words_[at + 1];
      const Word length = words_[at] >> 16;
      switch (static_cast<spv::Op>(words_[at] & 0xffffu)) {
        case spv::OpName:
          if (reinterpret_cast<const char*>(operands + 1) == array_name) array_ = operands[0];
          break;
        case spv::OpTypeFloat:
          float_type_ = operands[0];
          break;
        case spv::OpConstant:
          integers[operands[1]] = operands[2];
          break;
        case spv::OpAccessChain:
          if (operands[2] == array_ && length == 7) {
            const auto index = [&](int i) { return integers[operands[3 + i]]; };
            pointers[operands[1]] = static_cast<Word>((index(0) * edge + index(1)) * edge + index(2));
          }
          break;
        case spv::OpLoad:
          if (const auto pointer = pointers.find(operands[2]); pointer != pointers.end())
            loads_[operands[1]] = pointer->second;
          break;
        default:
          break;
      }
    }
  }

  void copy(const spv_parsed_instruction_t& instruction) {
    const auto op = static_cast<spv::Op>(instruction.opcode);
    const Word* words = instruction.words;
    if (op == spv::OpFunction && !constants_written_) write_constants();
    const bool is_of_array =
        (op == spv::OpName && words[1] == array_) || (op == spv::OpVariable && words[2] == array_) ||
        (op == spv::OpAccessChain && words[3] == array_) || (op == spv::OpLoad && loads_.contains(words[2]));
    if (is_of_array) return;
    const std::size_t begin = out_.size();
    out_.insert(out_.end(), words, words + instruction.num_words);
    for (std::uint16_t i = instruction.num_operands; i-- > 0;) {
      const spv_parsed_operand_t& operand = instruction.operands[i];
      if (operand.type != SPV_OPERAND_TYPE_ID) continue;
      const auto place = out_.begin() + static_cast<std::ptrdiff_t>(begin + operand.offset);
      if (*place == array_) {  // of the entry point's interface
        out_.erase(place);
        out_[begin] -= 1u << 16;
      } else if (const auto load = loads_.find(*place); load != loads_.end()) {
        *place = first_constant_ + load->second;
      }
    }
  }

  void write_constants() {
    constants_written_ = true;
    for (std::size_t k = 0; k < values_.size(); ++k) {
      out_.insert(out_.end(), {4u << 16 | spv::OpConstant, float_type_, first_constant_ + static_cast<Word>(k),
                               std::bit_cast<Word>(values_[k])});
    }
  }

  std::span<const Word> words_;
  std::span<const float> values_;
  std::unordered_map<Word, Word> loads_;  ///< the number of the value that is loaded
  std::vector<Word> out_;
  Word array_ = 0, float_type_ = 0, next_id_ = 0, first_constant_ = 0;
  bool constants_written_ = false;
};

}  // namespace

bool is_float_literal(std::string_view number) {
  if (number.starts_with("0x") || number.starts_with("0X")) return false;
  return number.find_first_of(".eEfF") != std::string_view::npos;
}

std::string Literals::place_of(std::string_view number) {
  const std::string text(number);
  auto known = numbers_.find(text);
  if (known == numbers_.end()) {
    double value = 0.0;
    const auto [rest, fault] = std::from_chars(number.data(), number.data() + number.size(), value);
    const std::string_view suffix(rest, static_cast<std::size_t>(number.data() + number.size() - rest));
    const bool is_plain = fault == std::errc() && (suffix.empty() || suffix == "f" || suffix == "F");
    if (!is_plain || values_.size() == most) return text;
    known = numbers_.emplace(text, values_.size()).first;
    values_.push_back(static_cast<float>(value));
    texts_.append(" ").append(text);
  }
  const std::size_t k = known->second;
  return fmt::format("{}[{}][{}][{}]", array_name, k / (edge * edge), k / edge % edge, k % edge);
}

std::string Literals::declaration() const {
  if (values_.empty()) return {};
  return fmt::format("float {0}[{1}][{1}][{1}];  //{2}\n", array_name, edge, texts_);
}

std::vector<std::uint32_t> Literals::put_back(std::vector<std::uint32_t> spirv) const {
  if (values_.empty() || spirv.empty()) return spirv;
  return Restorer(spirv, values_).run();
}

}  // namespace dmvv::compiler::snippet
