// Control flow: the blocks of SPIR-V become nested sequences by their merge instructions; phis become variables that
// are assigned on the edges into their block.
#include "compiler/snippet/read_spirv.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <glslang/SPIRV/spirv.hpp>
#include <set>
#include <spirv-tools/libspirv.hpp>
#include <spirv-tools/optimizer.hpp>

#include "compiler/snippet/spirv_values.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr std::size_t max_depth = 200;
constexpr std::size_t max_chain = 16;                       ///< cases of a switch that become else-ifs
constexpr std::size_t many_calls = 64;                      ///< in one block
constexpr std::uint64_t max_instructions = 1u << 19;        ///< of the program; an evaluation may execute twice as many
constexpr std::uint64_t max_spirv_instructions = 1u << 20;  ///< after inlining; some 5 a statement

class Reader {
 public:
  explicit Reader(const SpirvModule& module) : module_(module), values_(module, builder_) {}

  Result<Program> run() {
    walk(module_.first_block, 0);
    if (!values_.error().empty()) return fail(Fault::input, values_.error());
    return builder_.finish(values_.output());
  }

 private:
  /// What `leave` and `repeat` refer to.
  struct Construct {
    SpirvId merge;
    SpirvId next = 0;            ///< the continue target of a loop
    bool in_continuing = false;  ///< of a loop
    bool left = false;           ///< a leave was needed
    bool reached = false;        ///< the continue target is
    bool repeated = false;       ///< a repeat was needed
  };
  enum class Edge : std::uint8_t { falls, leaves, repeats, goes_on };

  bool failed() const { return !values_.error().empty(); }

  Construct* innermost_loop() {
    const auto place =
        std::find_if(constructs_.rbegin(), constructs_.rend(), [](const Construct& c) { return c.next != 0; });
    return place == constructs_.rend() ? nullptr : &*place;
  }

  Edge classify(SpirvId to, SpirvId stop) {
    if (to == stop || flags_.contains(to)) return Edge::falls;
    if (!constructs_.empty() && constructs_.back().merge == to) return Edge::leaves;
    const Construct* loop = innermost_loop();
    if (loop != nullptr && loop->next == to && !loop->in_continuing) return Edge::repeats;
    return Edge::goes_on;
  }

  /// Assigns the phis of `to`, all at once.
  void assign_phis(SpirvId from, SpirvId to) {
    std::vector<std::pair<Register, Register>> assignments;
    for (const SpirvInstruction& phi : block(to).phis) {
      const Scalars targets = values_.phi(phi);
      for (std::size_t i = 0; i + 1 < phi.operands.size(); i += 2) {
        if (phi.operands[i + 1] != from) continue;
        const Scalars sources = values_.value(phi.operands[i]);
        if (failed()) return;
        for (std::size_t k = 0; k < targets.size(); ++k) {
          if (targets[k] != sources[k]) assignments.emplace_back(targets[k], sources[k]);
        }
      }
    }
    std::set<Register> overwritten;
    for (const auto& assignment : assignments) overwritten.insert(assignment.first);
    for (auto& [target, source] : assignments) {  // sources that are overwritten on the way are kept aside
      if (overwritten.contains(source)) source = builder_.copy(source);
    }
    for (const auto& [target, source] : assignments) builder_.assign(target, source);
  }

  /// Follows an edge up to where it leaves the sequence; true if `to` is to be walked next.
  bool follow(SpirvId from, SpirvId to, SpirvId stop) {
    assign_phis(from, to);
    const Edge edge = classify(to, stop);
    Construct* loop = innermost_loop();
    if (loop != nullptr && loop->next == to) loop->reached = true;
    if (const auto flag = flags_.find(to); flag != flags_.end()) {
      builder_.assign(flag->second, builder_.constant(Type::boolean, 1));
    }
    if (edge == Edge::leaves) {
      constructs_.back().left = true;
      append(Node::Kind::leave);
    }
    if (edge == Edge::repeats) {
      loop->repeated = true;
      append(Node::Kind::repeat);
    }
    return edge == Edge::goes_on;
  }

  /// The sequence that begins with an edge.
  Sequence sequence(SpirvId from, SpirvId to, SpirvId stop) {
    builder_.begin();
    if (follow(from, to, stop)) walk(to, stop);
    return builder_.end();
  }

  void append(Node::Kind kind, Register condition = 0, Sequence body = {}, Sequence other = {}) {
    builder_.append(Node{.kind = kind, .condition = condition, .body = std::move(body), .other = std::move(other)});
  }

  const SpirvBlock& block(SpirvId label) const {
    static const SpirvBlock none;
    const auto place = module_.blocks.find(label);
    return place == module_.blocks.end() ? none : place->second;
  }

  /// Appends blocks from `label` on, until the flow reaches `stop` or leaves the sequence.
  void walk(SpirvId label, SpirvId stop) {
    if (++depth_ > max_depth) values_.refuse(fmt::format("control flow is nested deeper than {}", max_depth));
    for (SpirvId next = label; next != 0 && !failed();) {
      label = next;
      const SpirvBlock& current = block(label);
      if (current.merge.opcode == spv::OpLoopMerge && !open_loops_.contains(label)) {
        next = loop(label);
        continue;
      }
      if (!visited_.insert(label).second) {
        values_.refuse("its control flow is not structured");
        break;
      }
      for (const SpirvInstruction& phi : current.phis) values_.phi(phi);
      for (const SpirvInstruction& instruction : current.body) values_.execute(instruction);
      if (builder_.instruction_count() > max_instructions) {
        values_.refuse(fmt::format("it is longer than {} instructions", max_instructions));
      }
      if (!failed()) next = end_of_block(label, current, stop);
    }
    --depth_;
  }

  /// The block to walk next in this sequence, or 0.
  SpirvId end_of_block(SpirvId label, const SpirvBlock& current, SpirvId stop) {
    const auto& operands = current.terminator.operands;
    const SpirvId merge = current.merge.opcode == spv::OpSelectionMerge ? current.merge.operands[0] : 0;
    switch (current.terminator.opcode) {
      case spv::OpBranch:
        return follow(label, operands[0], stop) ? operands[0] : 0;
      case spv::OpBranchConditional:
        return merge != 0 ? selection(label, operands, merge) : exit_or_split(label, operands, stop);
      case spv::OpSwitch:
        if (merge != 0) return switch_statement(label, operands, merge);
        values_.refuse("its control flow is not structured");
        return 0;
      case spv::OpReturn:
      case spv::OpUnreachable:
        return 0;
      default:
        values_.refuse(opcode_name(current.terminator.opcode) + " is not something a distance function can use");
        return 0;
    }
  }

  SpirvId after(SpirvId merge) const { return block(merge).terminator.opcode == spv::OpUnreachable ? 0 : merge; }

  SpirvId selection(SpirvId label, std::span<const std::uint32_t> operands, SpirvId merge) {
    const Register condition = values_.scalar(operands[0]);
    Sequence yes = sequence(label, operands[1], merge);
    Sequence no = sequence(label, operands[2], merge);
    append(Node::Kind::branch, condition, std::move(yes), std::move(no));
    return after(merge);
  }

  /// A branch without merge: one side (or both) leaves the sequence.
  SpirvId exit_or_split(SpirvId label, std::span<const std::uint32_t> operands, SpirvId stop) {
    Register condition = values_.scalar(operands[0]);
    SpirvId yes = operands[1], no = operands[2];
    const auto exits = [&](SpirvId to) {
      const Edge edge = classify(to, stop);
      return edge == Edge::leaves || edge == Edge::repeats;
    };
    if (!exits(yes) && exits(no)) {
      condition = builder_.emit(Op::b_not, {condition});
      std::swap(yes, no);
    }
    Sequence body = sequence(label, yes, stop);
    if (exits(yes)) {
      append(Node::Kind::branch, condition, std::move(body));
      return follow(label, no, stop) ? no : 0;
    }
    Sequence other = sequence(label, no, stop);
    append(Node::Kind::branch, condition, std::move(body), std::move(other));
    return 0;
  }

  SpirvId loop(SpirvId header) {
    const SpirvId merge = block(header).merge.operands[0], next = block(header).merge.operands[1];
    open_loops_.insert(header);
    constructs_.push_back({.merge = merge, .next = next});
    builder_.begin();
    walk(header, next);
    Sequence body, continuing;
    const bool apart = constructs_.back().repeated;  // else the continuing part simply follows the body
    const bool reached = constructs_.back().reached;
    if (apart) {
      body = builder_.end();
      builder_.begin();
    }
    constructs_.back().in_continuing = true;
    if (reached && next != header) walk(next, header);
    (apart ? continuing : body) = builder_.end();
    constructs_.pop_back();
    append(reached ? Node::Kind::loop : Node::Kind::block, 0, std::move(body), std::move(continuing));
    return after(merge);
  }

  // ---- switch ----

  struct Case {
    SpirvId label;
    std::vector<std::uint32_t> literals;
    bool is_default = false;
  };

  /// Labels of other cases that the flow reaches from a case before it meets the merge.
  std::set<SpirvId> falls_from(SpirvId label, SpirvId merge, const std::vector<Case>& cases) const {
    std::set<SpirvId> falls, seen;
    std::vector<SpirvId> open{label};
    while (!open.empty()) {
      const SpirvId at = open.back();
      open.pop_back();
      if (at == merge || !seen.insert(at).second) continue;
      const bool is_case = std::any_of(cases.begin(), cases.end(), [&](const Case& c) { return c.label == at; });
      if (is_case && at != label) {
        falls.insert(at);
        continue;
      }
      if (std::any_of(constructs_.begin(), constructs_.end(),
                      [&](const Construct& c) { return c.merge == at || c.next == at; })) {
        continue;
      }
      const SpirvInstruction& terminator = block(at).terminator;
      const auto& operands = terminator.operands;
      if (terminator.opcode == spv::OpBranch) open.push_back(operands[0]);
      if (terminator.opcode == spv::OpBranchConditional) open.insert(open.end(), {operands[1], operands[2]});
      if (terminator.opcode == spv::OpSwitch) {
        for (std::size_t i = 1; i < operands.size(); i += 2) open.push_back(operands[i]);
      }
    }
    return falls;
  }

  /// In the order of their literals. A case that only breaks is kept: its literals must not run the default.
  static std::vector<Case> cases_of(std::span<const std::uint32_t> operands) {
    std::vector<Case> cases;
    const auto find = [&](SpirvId label) -> Case& {
      const auto known = std::find_if(cases.begin(), cases.end(), [&](const Case& c) { return c.label == label; });
      if (known != cases.end()) return *known;
      cases.push_back({.label = label, .literals = {}});
      return cases.back();
    };
    for (std::size_t i = 2; i + 1 < operands.size(); i += 2) find(operands[i + 1]).literals.push_back(operands[i]);
    find(operands[1]).is_default = true;
    return cases;
  }

  Register matches(const Case& one, Register selector) {
    Register any = builder_.constant(Type::boolean, 0);
    for (std::size_t i = 0; i < one.literals.size(); ++i) {
      const Register literal = builder_.constant(builder_.type(selector), one.literals[i]);
      const Op equal = builder_.type(selector) == Type::integer ? Op::i_eq : Op::u_eq;
      const Register hit = builder_.emit(equal, {selector, literal});
      any = i == 0 ? hit : builder_.emit(Op::b_or, {any, hit});
    }
    return any;
  }

  /// if (a) ... else if (b) ... else default: when no case falls into another.
  void chain(SpirvId label, Register selector, const std::vector<const Case*>& rest, const Case& default_case,
             SpirvId merge) {
    if (rest.empty()) {
      if (follow(label, default_case.label, merge)) walk(default_case.label, merge);
      return;
    }
    const Register hit = matches(*rest[0], selector);
    Sequence yes = sequence(label, rest[0]->label, merge);
    builder_.begin();
    chain(label, selector, {rest.begin() + 1, rest.end()}, default_case, merge);
    append(Node::Kind::branch, hit, std::move(yes), builder_.end());
  }

  SpirvId switch_statement(SpirvId label, std::span<const std::uint32_t> operands, SpirvId merge) {
    std::vector<Case> cases = cases_of(operands);
    Falls falls;
    bool flagged = cases.size() > max_chain;
    for (const Case& one : cases) {
      falls[one.label] = falls_from(one.label, merge, cases);
      flagged |= !falls[one.label].empty();
    }
    const Register selector = values_.scalar(operands[0]);
    constructs_.push_back({.merge = merge});
    builder_.begin();
    if (flagged) {
      flagged_cases(label, selector, in_order(cases, falls), merge);
    } else {
      std::vector<const Case*> others;
      for (const Case& one : cases) {
        if (!one.is_default) others.push_back(&one);
      }
      const auto default_case = std::find_if(cases.begin(), cases.end(), [](const Case& c) { return c.is_default; });
      chain(label, selector, others, *default_case, merge);
    }
    Sequence body = builder_.end();
    const bool left = constructs_.back().left;
    constructs_.pop_back();
    if (left) append(Node::Kind::block, 0, std::move(body));
    if (!left) builder_.append(std::move(body));
    return after(merge);
  }

  using Falls = std::map<SpirvId, std::set<SpirvId>>;

  /// Each case before those it falls into.
  static std::vector<Case> in_order(const std::vector<Case>& cases, const Falls& falls) {
    std::vector<Case> reversed;
    std::set<SpirvId> done;
    const std::function<void(const Case&)> place = [&](const Case& one) {
      if (!done.insert(one.label).second) return;
      for (const Case& next : cases) {
        if (falls.at(one.label).contains(next.label)) place(next);
      }
      reversed.push_back(one);
    };
    for (auto one = cases.rbegin(); one != cases.rend(); ++one) place(*one);
    return {reversed.rbegin(), reversed.rend()};
  }

  /// A flag a case says whether the flow enters it: by its literals, or from the case before. One `if` a case, in
  /// order.
  void flagged_cases(SpirvId label, Register selector, const std::vector<Case>& cases, SpirvId merge) {
    Register none = builder_.constant(Type::boolean, 1);
    for (const Case& one : cases) {
      if (!one.is_default) none = builder_.emit(Op::b_and, {none, builder_.emit(Op::b_not, {matches(one, selector)})});
    }
    for (const Case& one : cases) {
      const Register hit = one.is_default ? none : matches(one, selector);
      builder_.assign(flags_[one.label] = builder_.variable(Type::boolean), hit);
      builder_.begin();
      assign_phis(label, one.label);
      append(Node::Kind::branch, hit, builder_.end());
    }
    for (const Case& one : cases) {
      if (one.label == merge) continue;
      builder_.begin();
      walk(one.label, merge);
      append(Node::Kind::branch, flags_[one.label], builder_.end());
    }
  }

  const SpirvModule& module_;
  ProgramBuilder builder_;
  SpirvValues values_;
  std::vector<Construct> constructs_;
  std::set<SpirvId> open_loops_;
  std::set<SpirvId> visited_;
  std::map<SpirvId, Register> flags_;  ///< of cases that others may fall into
  std::size_t depth_ = 0;
};

using Words = std::vector<std::uint32_t>;

/// Inlines calls, merges returns and turns variables into values. No pass that folds constants: it would round in
/// float32 what is to be computed in double (a division by 1000 would become a product with 0.001f), and none that
/// removes dead code: with it would go loops that never end, which the author is to hear of.
///
/// The SPIR-V is checked first where it comes from outside; without names in the messages: they are made for every id,
/// whether there is a message or not.
Result<Words> optimize(std::span<const std::uint32_t> spirv, bool is_checked,
                       std::vector<spvtools::Optimizer::PassToken> passes) {
  std::string log;
  spvtools::ValidatorOptions validation;
  validation.SetFriendlyNames(false);
  spvtools::OptimizerOptions options;
  options.set_validator_options(validation);
  options.set_run_validator(!is_checked);
  spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_2);
  optimizer.SetMessageConsumer(
      [&log](spv_message_level_t level, const char*, const spv_position_t&, const char* message) {
        if (level <= SPV_MSG_ERROR) log += std::string(message) + '\n';
      });
  for (auto& pass : passes) optimizer.RegisterPass(std::move(pass));
  Words out;
  if (!optimizer.Run(spirv.data(), spirv.size(), &out, options)) {
    return fail(Fault::input, "SPIRV-Tools refuses the SPIR-V", {log});
  }
  return out;
}

template <class... Passes>
std::vector<spvtools::Optimizer::PassToken> list(Passes... passes) {
  std::vector<spvtools::Optimizer::PassToken> out;
  (out.push_back(std::move(passes)), ...);
  return out;
}

/// Removes access chains that nothing uses: they are left over from the passes, and keep variables from becoming
/// values. A literal that looks like the id keeps the chain; that costs a little speed only.
Words without_unused_chains(const Words& words) {
  std::map<std::uint32_t, int> mentions;
  for (const std::uint32_t word : words) ++mentions[word];
  Words out(words.begin(), words.begin() + 5);
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    const bool unused = (words[at] & 0xffffu) == spv::OpAccessChain && mentions[words[at + 2]] == 1;
    if (!unused)
      out.insert(out.end(), words.begin() + static_cast<std::ptrdiff_t>(at),
                 words.begin() + static_cast<std::ptrdiff_t>(at + (words[at] >> 16)));
  }
  return out;
}

/// Ends a block behind each of its calls, where it has many: inlining a call moves all that follows in its block, which
/// for thousands of calls in one block would take minutes. Of what control flow means nothing changes.
Words with_calls_apart(std::span<const std::uint32_t> words) {
  std::map<SpirvId, std::size_t> calls;  // by block
  std::map<SpirvId, SpirvId> last_part;  // of a block that is divided, where its terminator comes to stand
  SpirvId label = 0, next_id = words[3];
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    const std::uint32_t op = words[at] & 0xffffu;
    if (op == spv::OpLabel) label = words[at + 1];
    if (op == spv::OpFunctionCall) ++calls[label];
    if (op == spv::OpLoopMerge) calls.erase(label);  // a loop's head stays whole
  }
  std::erase_if(calls, [](const auto& block) { return block.second < many_calls; });
  if (calls.empty()) return {words.begin(), words.end()};
  for (const auto& [block, count] : calls) {
    next_id += static_cast<SpirvId>(count);
    last_part[block] = next_id - 1;
  }
  Words out(words.begin(), words.begin() + 5);
  out[3] = next_id;
  SpirvId part = 0;
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    const std::uint32_t op = words[at] & 0xffffu, length = words[at] >> 16;
    const std::size_t begin = out.size();
    out.insert(out.end(), words.begin() + static_cast<std::ptrdiff_t>(at),
               words.begin() + static_cast<std::ptrdiff_t>(at + length));
    if (op == spv::OpLabel) {
      label = words[at + 1];
      const auto divided = calls.find(label);
      part = divided == calls.end() ? 0 : last_part[label] + 1 - static_cast<SpirvId>(divided->second);
    }
    if (op == spv::OpFunctionCall && calls.contains(label)) {
      out.insert(out.end(), {2u << 16 | spv::OpBranch, part, 2u << 16 | spv::OpLabel, part});
      ++part;
    }
    for (std::size_t i = 4; op == spv::OpPhi && i < length; i += 2) {  // its ways come from where blocks end now
      if (const auto moved = last_part.find(out[begin + i]); moved != last_part.end()) out[begin + i] = moved->second;
    }
  }
  return out;
}

Result<Words> prepare(std::span<const std::uint32_t> spirv) {
  const auto inlined =
      optimize(with_calls_apart(spirv), false,
               list(spvtools::CreateMergeReturnPass(), spvtools::CreateInlineExhaustivePass(),
                    spvtools::CreateEliminateDeadFunctionsPass(), spvtools::CreatePrivateToLocalPass(),
                    spvtools::CreateScalarReplacementPass(0), spvtools::CreateLocalAccessChainConvertPass(),
                    spvtools::CreateLocalSingleBlockLoadStoreElimPass(), spvtools::CreateLocalSingleStoreElimPass()));
  if (!inlined) return inlined;
  return optimize(without_unused_chains(*inlined), true, list(spvtools::CreateSSARewritePass()));
}

}  // namespace

Result<Program> read_spirv(std::span<const std::uint32_t> spirv) {
  if (const auto calls = check_calls(spirv, max_spirv_instructions); !calls)
    return tl::unexpected<Error>(calls.error());
  const auto prepared = prepare(spirv);
  if (!prepared) return tl::unexpected<Error>(prepared.error());
  const auto module = parse_spirv(*prepared);
  if (!module) return tl::unexpected<Error>(module.error());
  return Reader(*module).run();
}

}  // namespace dmvv::compiler::snippet
