// Program -> GLSL: `float NAME(vec3 p)`, statements over scalars, structured control flow.
//
//   t0, t1, ...  what depends on t alone, read from time_values (time_values.h)
//   v0, v1, ...  variables      r0, r1, ...  temporaries      a0, a1, ...  arrays      g0, g1, ...  rounds of loops
//
// A temporary with one use is written where it is used, unless the line would grow too long.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>

#include "compiler/snippet/device_functions.h"
#include "compiler/snippet/glsl_forms.h"
#include "compiler/snippet/nest_exits.h"
#include "compiler/snippet/snippet.h"
#include "compiler/snippet/time_values.h"

namespace dmvv::compiler::snippet {

namespace {

using ranks::loosest, ranks::primary, ranks::unary;

constexpr std::size_t longest_inlined =
    64;  // characters of an expression that is written into another, literals not counted
/// Rounds of a loop on a device; lavapipe allows as many to a shader invocation. Loops that do not end were refused.
constexpr int most_rounds = 65535;

std::string zero(Type type) { return literal({type, 0}); }

/// Characters but for those of numbers: snippets that differ in constants alone are written alike
/// (compiler/glsl/families.h).
std::size_t length_without_numbers(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return std::string_view("0123456789.-").find(c) == std::string_view::npos; }));
}

class Emitter {
 public:
  /// Results are registers to be read after the last statement, each by one call of `result`.
  Emitter(const Program& program, std::span<const Hoisted> hoisted, std::span<const Register> results,
          std::string_view function_prefix, std::string_view indentation)
      : program_(program),
        hoisted_(hoisted),
        function_prefix_(function_prefix),
        indentation_(indentation),
        uses_(program_.register_count() + hoisted.size(), 0) {
    count_uses(program_.body);
    find_first_mentions(program_.body, true);
    for (const Register r : results) {
      ++uses_[r];
      mention(r, no_instruction, true);
    }
    find_initial_elements();
  }

  std::string statements(std::size_t first_time_value) {
    declare_time_values(first_time_value);
    declare_arrays();
    declare_variables();
    sequence(program_.body);
    return std::move(text_);
  }

  std::string result(Register r) { return operand(r, loosest); }

 private:
  struct Expression {
    std::string text;
    int rank = primary;
    std::vector<Register> reads;  ///< variables; arrays come after all registers
  };

  // ---- what is used, and where first ----

  void count_uses(const Sequence& nodes) {
    for (const Node& node : nodes) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Instruction& instruction = program_.instructions[i];
        const std::string_view letters = info(instruction.op).operands;
        for (std::size_t k = 0; k < letters.size(); ++k) {
          if (letters[k] != 'a') ++uses_[instruction.operands[k]];
          if (letters[k] == 'a') array_used(instruction.operands[k]);
        }
      }
      if (node.kind == Node::Kind::branch) ++uses_[node.condition];
      count_uses(node.body);
      count_uses(node.other);
    }
  }

  void array_used(Register array) {
    elements_.resize(program_.arrays.size());
    elements_[array].resize(program_.arrays[array].size, zero(program_.arrays[array].type));
  }

  /// Stores of known values to known places, before anything is loaded or decided, become initialisers.
  void find_initial_elements() {
    std::vector<bool> closed(program_.arrays.size(), false);
    for (const Node& node : program_.body) {
      if (node.kind != Node::Kind::run) return;
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Instruction& instruction = program_.instructions[i];
        const OpInfo& table = info(instruction.op);
        if (table.operands.empty() || table.operands[0] != 'a') continue;
        const auto [array, index, value] = instruction.operands;
        const bool known = table.result == '-' && program_.is_constant(index) &&
                           program_.constant(index).bits < program_.arrays[array].size &&
                           (value >= program_.register_count() || program_.is_constant(value));
        if (!known) closed[array] = true;
        if (closed[array]) continue;
        elements_[array][program_.constant(index).bits] = named(value).text;
        is_initial_.insert(i);
      }
    }
  }

  /// Does nothing but initialisers change the array, and are these constants?
  bool is_table(Register array) const {
    for (std::uint32_t i = 0; i < program_.instructions.size(); ++i) {
      const auto& [op, result, operands] = program_.instructions[i];
      if (info(op).result != '-' || operands[0] != array) continue;
      if (!is_initial_.contains(i) || !program_.is_constant(operands[2])) return false;
    }
    return true;
  }

  /// A variable whose first mention is an assignment outside of all control flow is declared there.
  void find_first_mentions(const Sequence& nodes, bool outermost) {
    mentioned_.resize(program_.register_count(), false);
    starts_at_.resize(program_.register_count(), no_instruction);
    for (const Node& node : nodes) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Instruction& instruction = program_.instructions[i];
        const OpInfo& table = info(instruction.op);
        for (std::size_t k = 0; k < table.operands.size(); ++k) {
          if (table.operands[k] != 'a') mention(instruction.operands[k], no_instruction, outermost);
        }
        if (table.result != '-') mention(instruction.result, i, outermost);
      }
      if (node.kind == Node::Kind::branch) mention(node.condition, no_instruction, outermost);
      find_first_mentions(node.body, false);
      find_first_mentions(node.other, false);
    }
  }

  void mention(Register r, std::uint32_t assigned_by, bool outermost) {
    if (r >= program_.register_count() || !program_.is_variable(r) || mentioned_[r]) return;
    mentioned_[r] = true;
    if (outermost) starts_at_[r] = assigned_by;
  }

  // ---- declarations ----

  void declare_time_values(std::size_t first) {
    for (std::size_t k = 0; k < hoisted_.size(); ++k) {
      const std::size_t slot = first + hoisted_[k].first_slot;
      const Type type = hoisted_[k].type;
      line("{} t{} = {};", type_name(type), k,
           time_value_text(type, fmt::format("{}", slot), fmt::format("{}", slot + 1)));
    }
  }

  void declare_arrays() {
    for (std::size_t a = 0; a < elements_.size(); ++a) {
      if (elements_[a].empty()) continue;
      line("{4}{0} a{1}[{2}] = {0}[{2}]({3});", type_name(program_.arrays[a].type), a, elements_[a].size(),
           fmt::join(elements_[a], ", "), is_table(static_cast<Register>(a)) ? "const " : "");
    }
  }

  void declare_variables() {
    for (const Type type : {Type::real, Type::integer, Type::unsigned_integer, Type::boolean}) {
      std::string names;
      for (std::size_t v = 0; v < program_.variables.size(); ++v) {
        const Register r = program_.first_variable() + static_cast<Register>(v);
        if (program_.variables[v] != type || !mentioned_[r] || starts_at_[r] != no_instruction) continue;
        names += fmt::format("{}v{} = {}", names.empty() ? "" : ", ", v, zero(type));
      }
      if (!names.empty()) line("{} {};", type_name(type), names);
    }
  }

  // ---- operands ----

  Expression named(Register r) const {
    if (r >= program_.register_count()) return {fmt::format("t{}", r - program_.register_count()), primary, {}};
    if (program_.is_constant(r)) {
      std::string text = literal(program_.constant(r));
      const int rank = text[0] == '-' ? unary : primary;
      return {std::move(text), rank, {}};
    }
    if (program_.is_variable(r)) return {fmt::format("v{}", r - program_.first_variable()), primary, {r}};
    if (program_.is_temporary(r)) return {fmt::format("r{}", r - program_.first_temporary()), primary, {}};
    return {r == Program::t ? "t" : fmt::format("p.{}", "xyz"[r]), primary, {}};
  }

  Expression take(Register r) {
    const auto waiting = waiting_.find(r);
    if (waiting == waiting_.end()) return named(r);
    Expression expression = std::move(waiting->second);
    waiting_.erase(waiting);
    return expression;
  }

  static std::string wrapped(const Expression& expression, int loosest_rank) {
    return expression.rank <= loosest_rank ? expression.text : "(" + expression.text + ")";
  }

  std::string operand(Register r, int loosest_rank) { return wrapped(take(r), loosest_rank); }

  /// Gives a waiting expression its own line, so that it can be named twice.
  void settle(Register r) {
    const auto waiting = waiting_.find(r);
    if (waiting == waiting_.end()) return;
    declare(r, waiting->second.text);
    waiting_.erase(waiting);
  }

  void settle_all() {
    while (!waiting_.empty()) settle(waiting_.begin()->first);
  }

  /// Before a variable (or array) changes: what reads it and still waits.
  void settle_readers(Register changed) {
    std::vector<Register> readers;
    for (const auto& [r, expression] : waiting_) {
      if (std::ranges::find(expression.reads, changed) != expression.reads.end()) readers.push_back(r);
    }
    for (const Register r : readers) settle(r);
  }

  void declare(Register r, const std::string& value) {
    line("{} {} = {};", type_name(program_.type(r)), named(r).text, value);
  }

  // ---- instructions ----

  Expression expression_of(const Instruction& instruction) {
    const Form form = form_of(instruction.op);
    Expression made{"", form.rank, {}};
    std::array<std::string, 3> operands;
    const std::size_t count = info(instruction.op).operands.size();
    for (std::size_t k = 0; k < count; ++k) {
      const std::string placeholder = {'$', static_cast<char>('0' + k)};
      if (form.pattern.find(placeholder) != form.pattern.rfind(placeholder)) settle(instruction.operands[k]);
      Expression part = take(instruction.operands[k]);
      if (form.pattern == "$0") made.rank = part.rank;
      const int infix = form.rank - (k == 0 ? 0 : 1);
      operands[k] = wrapped(part, form.rank == primary ? loosest : form.rank == unary ? primary : infix);
      made.reads.insert(made.reads.end(), part.reads.begin(), part.reads.end());
    }
    made.text = filled(form.pattern, operands, function_prefix_, named(instruction.result).text);
    return made;
  }

  /// An element of an array; an index that is not known to lie inside is clamped.
  Expression element(Register array, Register index) {
    const std::uint32_t last = program_.arrays[array].size - 1;
    Expression at = take(index);
    const bool known = program_.is_constant(index) && program_.constant(index).bits <= last;
    if (!known) at.text = fmt::format("clamp({}, 0, {})", at.text, last);
    at.reads.push_back(program_.register_count() + array);
    return {fmt::format("a{}[{}]", array, at.text), primary, std::move(at.reads)};
  }

  void emit(std::uint32_t i) {
    const Instruction& instruction = program_.instructions[i];
    const OpInfo& table = info(instruction.op);
    if (table.result == '-') return is_initial_.contains(i) ? void() : store(instruction);
    const Form form = form_of(instruction.op);
    if (form.pattern.find("$x") != std::string_view::npos || form.pattern.find("$r") != std::string_view::npos) {
      return call_with_results(instruction, i);
    }
    const bool is_load = table.operands[0] == 'a';
    Expression value = is_load ? element(instruction.operands[0], instruction.operands[1]) : expression_of(instruction);
    if (program_.is_variable(instruction.result)) return assign(instruction.result, value.text, i);
    if (uses_[instruction.result] == 1 && length_without_numbers(value.text) <= longest_inlined) {
      waiting_.emplace(instruction.result, std::move(value));
    } else {
      declare(instruction.result, value.text);
    }
  }

  void assign(Register variable, const std::string& value, std::uint32_t i) {
    settle_readers(variable);
    if (starts_at_[variable] == i) return declare(variable, value);
    line("{} = {};", named(variable).text, value);
  }

  void store(const Instruction& instruction) {
    const Register array = instruction.operands[0];
    const Expression place = element(array, instruction.operands[1]);
    const std::string value = operand(instruction.operands[2], loosest);
    settle_readers(program_.register_count() + array);
    line("{} = {};", place.text, value);
  }

  /// Operations that GLSL gives back by parameters: to $r, and to $x what is not wanted.
  void call_with_results(const Instruction& instruction, std::uint32_t i) {
    const std::string call = expression_of(instruction).text;
    const Register r = instruction.result;
    const bool returns = instruction.op == Op::f_frexp_mantissa;
    const Type other = returns ? Type::integer : program_.type(r);
    if (program_.is_variable(r)) settle_readers(r);
    if (call.find(named(r).text + "_x") != std::string::npos) line("{} {}_x;", type_name(other), named(r).text);
    const bool is_declared = program_.is_variable(r) && starts_at_[r] != i;
    if (returns) return is_declared ? line("{} = {};", named(r).text, call) : declare(r, call);
    if (!is_declared) line("{} {};", type_name(program_.type(r)), named(r).text);
    line("{};", call);
  }

  // ---- control flow ----

  void sequence(const Sequence& nodes) {
    for (const Node& node : nodes) {
      switch (node.kind) {
        case Node::Kind::run:
          for (std::uint32_t i = node.first; i < node.first + node.count; ++i) emit(i);
          break;
        case Node::Kind::branch:
          branch(node);
          break;
        case Node::Kind::loop:
          loop(node);
          break;
        case Node::Kind::block:
          block(node);
          break;
        case Node::Kind::leave:
          return line("break;");
        case Node::Kind::repeat:
          return line("continue;");
      }
    }
  }

  void inside(const Sequence& nodes) {
    ++depth_;
    sequence(nodes);
    settle_all();
    --depth_;
  }

  static bool is_exit(const Sequence& nodes) {
    return nodes.size() == 1 && (nodes[0].kind == Node::Kind::leave || nodes[0].kind == Node::Kind::repeat);
  }

  static std::string_view exit_of(const Sequence& nodes) {
    return nodes[0].kind == Node::Kind::leave ? "break;" : "continue;";
  }

  void branch(const Node& node) {
    const Expression condition = take(node.condition);
    settle_all();
    if (node.body.empty() && node.other.empty()) return;
    const std::string negated = "!" + wrapped(condition, primary);
    if (node.other.empty() && is_exit(node.body)) {
      return line("if ({}) {}", condition.text, exit_of(node.body));
    }
    if (node.body.empty() && is_exit(node.other)) return line("if ({}) {}", negated, exit_of(node.other));
    if (node.body.empty()) {
      line("if ({}) {{", negated);
      inside(node.other);
    } else {
      line("if ({}) {{", condition.text);
      inside(node.body);
      if (!node.other.empty()) {
        line("}} else {{");
        inside(node.other);
      }
    }
    line("}}");
  }

  /// The continuing part follows the body; where something repeats the loop from within, it stands before the next
  /// round instead, which comes to the same.
  void loop(const Node& node) {
    settle_all();
    const int round = loops_++;
    line("for (int g{0} = 0; g{0} < {1}; ++g{0}) {{", round, most_rounds);
    const bool first = !node.other.empty() && repeats(node.body);
    if (first) {
      ++depth_;
      line("if (g{} > 0) {{", round);
      inside(node.other);
      line("}}");
      --depth_;
    }
    inside(node.body);
    if (!first) inside(node.other);
    line("}}");
  }

  void block(const Node& node) {
    Sequence body = node.body;
    nest(body, 0);
    if (!leaves(body)) return sequence(body);
    settle_all();
    line("switch (0) {{");
    line("default:");
    inside(body);
    line("}}");
  }

  template <class... Parts>
  void line(fmt::format_string<Parts...> format, Parts&&... parts) {
    text_ += indentation_;
    text_.append(static_cast<std::size_t>(2 * depth_), ' ');
    text_ += fmt::format(format, std::forward<Parts>(parts)...);
    text_ += '\n';
  }

  static constexpr std::uint32_t no_instruction = ~0u;

  const Program& program_;
  std::span<const Hoisted> hoisted_;
  std::string_view function_prefix_;
  std::string_view indentation_;
  std::vector<std::uint32_t> uses_;
  std::vector<std::vector<std::string>> elements_;  ///< of the arrays in use, at the start
  std::set<std::uint32_t> is_initial_;              ///< stores that are initialisers
  std::vector<bool> mentioned_;                     ///< variables
  std::vector<std::uint32_t> starts_at_;            ///< of a variable: the assignment that declares it
  std::map<Register, Expression> waiting_;          ///< temporaries to be written where they are used
  std::string text_;
  int depth_ = 0;
  int loops_ = 0;
};

/// How the time values are computed, as comments: snippets whose texts are equal have equal time values as well.
std::string schedule_text(const TimeSplit& split) {
  std::vector<Register> results;
  for (const TimeSlot& slot : split.slots) results.push_back(slot.result);
  Emitter emitter(split.schedule, {}, results, "", "  //   ");
  std::string text = "  // Computed beforehand from t:\n" + emitter.statements(0);
  for (std::size_t k = 0; k < split.slots.size(); ++k) {
    constexpr std::string_view reduced[] = {"", ", mod 2 pi", ", mod 1"};
    text += fmt::format("  //   {}: {}{}\n", k, emitter.result(split.slots[k].result),
                        reduced[static_cast<std::size_t>(split.slots[k].period)]);
  }
  return text;
}

}  // namespace

std::string Snippet::glsl(std::string_view name, std::size_t first_time_value) const {
  const TimeSplit& split = time_split();
  const std::string prefix = fmt::format("{}_", name);
  Emitter emitter(split.residual, split.hoisted, {&split.residual.result, 1}, prefix, "  ");
  std::string text = device_functions(split.residual.instructions, prefix) + fmt::format("float {}(vec3 p) {{\n", name);
  if (!split.slots.empty()) text += schedule_text(split);
  text += emitter.statements(first_time_value);
  return text + fmt::format("  return {};\n}}\n", emitter.result(split.residual.result));
}

}  // namespace dmvv::compiler::snippet
