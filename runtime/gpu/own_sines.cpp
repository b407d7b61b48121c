#include "runtime/gpu/own_sines.h"

#include <bit>
#include <cstring>
#include <initializer_list>
#include <map>

namespace dmvv::runtime {
namespace {

// Opcodes and numbers of the SPIR-V specification and of the extended instructions GLSL.std.450.
enum Opcode : std::uint32_t {
  op_ext_inst_import = 11,
  op_ext_inst = 12,
  op_type_void = 19,
  op_type_float = 22,
  op_type_function = 33,
  op_constant = 43,
  op_function = 54,
  op_decorate = 71,
  op_f_add = 129,
  op_f_sub = 131,
  op_f_mul = 133,
  op_f_div = 136,
};
enum Extended : std::uint32_t { round_even = 2, floor_of = 8, sine = 13, cosine = 14, tangent = 15, clamp_of = 43 };
constexpr std::uint32_t no_contraction = 42;
constexpr std::size_t header_words = 5, bound_word = 3;

using Words = std::vector<std::uint32_t>;

class Rewriter {
 public:
  explicit Rewriter(std::span<const std::uint32_t> words) : words_(words), bound_(words[bound_word]) {
    for_each([&](std::span<const std::uint32_t> instruction) {
      const std::uint32_t opcode = instruction[0] & 0xffffu;
      if (opcode == op_type_float && instruction[2] == 32) float_ = instruction[1];
      if (opcode == op_ext_inst_import &&
          std::strcmp(reinterpret_cast<const char*>(&instruction[2]), "GLSL.std.450") == 0) {
        set_ = instruction[1];
      }
    });
  }

  Words run() {
    // ---- what is before the types, the types and constants, the functions ----
    Words annotations(words_.begin(), words_.begin() + header_words), types, functions;
    Words* part = &annotations;
    for_each([&](std::span<const std::uint32_t> instruction) {
      const std::uint32_t opcode = instruction[0] & 0xffffu;
      if (part == &annotations && opcode >= op_type_void && opcode <= op_type_function) part = &types;
      if (opcode == op_function) part = &functions;
      if (opcode == op_ext_inst && is_sine(instruction))
        return write_out(instruction[4], instruction[5], instruction[2], functions);
      part->insert(part->end(), instruction.begin(), instruction.end());
    });
    if (made_.empty()) return {words_.begin(), words_.end()};

    for (const std::uint32_t id : made_) put(annotations, op_decorate, {id, no_contraction});
    annotations[bound_word] = bound_;
    annotations.insert(annotations.end(), types.begin(), types.end());
    for (const auto& [bits, id] : constants_) put(annotations, op_constant, {float_, id, bits});
    annotations.insert(annotations.end(), functions.begin(), functions.end());
    return annotations;
  }

 private:
  template <class Use>
  void for_each(Use use) const {
    for (std::size_t at = header_words; at < words_.size();) {
      const std::size_t count = words_[at] >> 16u;
      use(words_.subspan(at, count));
      at += count;
    }
  }

  bool is_sine(std::span<const std::uint32_t> instruction) const {
    return instruction[1] == float_ && instruction[3] == set_ && instruction[4] >= sine && instruction[4] <= tangent;
  }

  static void put(Words& to, std::uint32_t opcode, std::initializer_list<std::uint32_t> operands) {
    to.push_back(static_cast<std::uint32_t>(operands.size() + 1) << 16u | opcode);
    to.insert(to.end(), operands);
  }

  std::uint32_t constant(float value) {
    const auto [found, is_new] = constants_.try_emplace(std::bit_cast<std::uint32_t>(value), bound_);
    if (is_new) ++bound_;
    return found->second;
  }

  /// An instruction that makes a float; its result has the id `as`, or a new one.
  std::uint32_t make(Words& to, std::uint32_t opcode, std::initializer_list<std::uint32_t> operands,
                     std::uint32_t as = 0) {
    const std::uint32_t id = as != 0 ? as : bound_++;
    to.push_back(static_cast<std::uint32_t>(operands.size() + 3) << 16u | opcode);
    to.insert(to.end(), {float_, id});
    to.insert(to.end(), operands);
    if (opcode != op_ext_inst) made_.push_back(id);
    return id;
  }

  /// sin(x), or cos(x) = sin(x + pi/2), of what is left of x without the nearest multiple of pi.
  std::uint32_t write_sine(std::uint32_t x, bool is_cosine, Words& to, std::uint32_t as = 0) {
    const auto add = [&](std::uint32_t a, std::uint32_t b) { return make(to, op_f_add, {a, b}); };
    const auto subtract = [&](std::uint32_t a, std::uint32_t b) { return make(to, op_f_sub, {a, b}); };
    const auto multiply = [&](std::uint32_t a, std::uint32_t b) { return make(to, op_f_mul, {a, b}); };
    const auto extended = [&](std::uint32_t function, std::uint32_t a) {
      return make(to, op_ext_inst, {set_, function, a});
    };

    // ---- turns: how often pi is taken away; half of it more for a cosine ----
    const std::uint32_t share = multiply(x, constant(0.31830987f)), half = constant(0.5f);
    const std::uint32_t count = extended(round_even, is_cosine ? add(share, half) : share);
    const std::uint32_t turns = is_cosine ? subtract(count, half) : count;

    // ---- pi = 201 / 2^6 + 1015 / 2^20 + rest; products of the first two with either half of the turns' bits are exact
    // ----
    constexpr float many = 2048.0f, pi_high = 201.0f / 64.0f, pi_middle = 1015.0f / 1048576.0f,
                    pi_rest = -3.2584136e-7f;
    const std::uint32_t coarse = extended(round_even, multiply(turns, constant(1.0f / many)));
    const std::uint32_t fine = subtract(turns, multiply(coarse, constant(many)));
    std::uint32_t rest = subtract(x, multiply(coarse, constant(many * pi_high)));
    rest = subtract(rest, multiply(fine, constant(pi_high)));
    rest = subtract(rest, multiply(coarse, constant(many * pi_middle)));
    rest = subtract(rest, multiply(fine, constant(pi_middle)));
    rest = subtract(rest, multiply(turns, constant(pi_rest)));

    // ---- the series to the 11th power: 6e-8 off at pi/2 ----
    const std::uint32_t square = multiply(rest, rest);
    std::uint32_t sum = constant(-1.0f / 39916800.0f);
    for (const float factor : {1.0f / 362880.0f, -1.0f / 5040.0f, 1.0f / 120.0f, -1.0f / 6.0f}) {
      sum = add(multiply(sum, square), constant(factor));
    }
    const std::uint32_t value = add(rest, multiply(rest, multiply(square, sum)));

    // ---- after an odd number of turns it is the other way round ----
    const std::uint32_t odd = subtract(count, multiply(extended(floor_of, multiply(count, half)), constant(2.0f)));
    const std::uint32_t sign = subtract(constant(1.0f), multiply(odd, constant(2.0f)));
    return make(to, op_ext_inst, {set_, clamp_of, multiply(value, sign), constant(-1.0f), constant(1.0f)}, as);
  }

  void write_out(std::uint32_t function, std::uint32_t x, std::uint32_t result, Words& to) {
    if (function != tangent) {
      write_sine(x, function == cosine, to, result);
      return;
    }
    const std::uint32_t over = write_sine(x, false, to), under = write_sine(x, true, to);
    make(to, op_f_div, {over, under}, result);
  }

  std::span<const std::uint32_t> words_;
  std::uint32_t bound_;
  std::uint32_t float_ = 0, set_ = 0;
  std::map<std::uint32_t, std::uint32_t> constants_;  ///< bits to id
  Words made_;                                        ///< ids of sums, products and quotients
};

}  // namespace

std::vector<std::uint32_t> with_own_sines(std::span<const std::uint32_t> words) { return Rewriter(words).run(); }

}  // namespace dmvv::runtime
