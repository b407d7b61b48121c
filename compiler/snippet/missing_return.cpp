// glslang ends a function whose last block is open by returning an undefined value.
#include "compiler/snippet/missing_return.h"

#include <glslang/SPIRV/spirv.hpp>
#include <map>
#include <set>

namespace dmvv::compiler::snippet {
namespace {

using Word = std::uint32_t;

struct Block {
  std::vector<Word> next;
  bool returns_undefined = false;
};

/// What is needed of a module, gathered in one walk over its instructions.
class Module {
 public:
  explicit Module(std::span<const Word> words) {
    constexpr std::size_t header = 5;
    for (std::size_t i = header; i < words.size();) {
      const std::size_t length = words[i] >> 16;
      if (length == 0 || i + length > words.size()) return;
      read(static_cast<spv::Op>(words[i] & 0xffffu), words.subspan(i + 1, length - 1));
      i += length;
    }
  }

  std::vector<std::string> result;

 private:
  void read(spv::Op op, std::span<const Word> operands) {
    switch (op) {
      case spv::OpName:
        names_[operands[0]] = reinterpret_cast<const char*>(&operands[1]);
        break;
      case spv::OpUndef:
        undefined_.insert(operands[1]);
        break;
      case spv::OpConstantTrue:
        constants_[operands[1]] = true;
        break;
      case spv::OpConstantFalse:
        constants_[operands[1]] = false;
        break;
      case spv::OpFunction:
        function_ = operands[1];
        blocks_.clear();
        first_ = 0;
        break;
      case spv::OpLabel:
        block_ = operands[0];
        if (first_ == 0) first_ = block_;
        blocks_[block_];
        break;
      case spv::OpBranch:
        blocks_[block_].next = {operands[0]};
        break;
      case spv::OpBranchConditional:
        branch(operands);
        break;
      case spv::OpSwitch:
        blocks_[block_].next = {operands[1]};
        for (std::size_t i = 3; i < operands.size(); i += 2) blocks_[block_].next.push_back(operands[i]);
        break;
      case spv::OpReturnValue:
        blocks_[block_].returns_undefined = undefined_.contains(operands[0]);
        break;
      case spv::OpFunctionEnd:
        if (reaches_undefined()) result.push_back(names_[function_]);
        break;
      default:
        break;
    }
  }

  void branch(std::span<const Word> operands) {
    const auto constant = constants_.find(operands[0]);
    if (constant == constants_.end()) {
      blocks_[block_].next = {operands[1], operands[2]};
    } else {
      blocks_[block_].next = {constant->second ? operands[1] : operands[2]};
    }
  }

  bool reaches_undefined() {
    std::set<Word> seen = {first_};
    std::vector<Word> open = {first_};
    while (!open.empty()) {
      const Block& block = blocks_[open.back()];
      open.pop_back();
      if (block.returns_undefined) return true;
      for (const Word next : block.next) {
        if (seen.insert(next).second) open.push_back(next);
      }
    }
    return false;
  }

  std::map<Word, std::string> names_;
  std::map<Word, bool> constants_;
  std::set<Word> undefined_;
  std::map<Word, Block> blocks_;  // of the function that is being read
  Word function_ = 0, block_ = 0, first_ = 0;
};

}  // namespace

std::vector<std::string> functions_without_return(std::span<const std::uint32_t> spirv) { return Module(spirv).result; }

}  // namespace dmvv::compiler::snippet
