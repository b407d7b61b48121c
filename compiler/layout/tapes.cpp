#include "compiler/layout/tapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>

#include "compiler/layout/tape_cells.h"
#include "compiler/shader_text.h"
#include "compiler/snippet/device_values.h"
#include "compiler/snippet/time_range.h"

namespace dmvv::compiler {

namespace {

using snippet::StraightLine;
using snippet::Tape;
using snippet::TimeSplit;

/// Times at which a device reads what it may: none that a double can count in milliseconds is beyond.
constexpr snippet::Interval all_times{-any_time_ms, any_time_ms};

/// What a snippet may take in any case, for each of its steps: beyond 10,000 the shared budget ends before its tapes
/// are short enough to draw a picture with.
constexpr std::uint64_t most_work_a_step = 2000;

/// As the shaders compare with it: in float32.
std::vector<IsoRange> iso_ranges(const Module& module) {
  std::vector<std::optional<IsoRange>> ranges(module.functions.size());
  for (const Sdf& sdf : module.sdfs) {
    const auto* function = std::get_if<Id<Function>>(&sdf.source);
    if (function == nullptr) continue;
    const double iso = static_cast<float>(sdf.iso);
    std::optional<IsoRange>& range = ranges[function->index];
    range = range ? IsoRange{std::min(range->lo, iso), std::max(range->hi, iso)} : IsoRange{iso, iso};
  }
  std::vector<IsoRange> out;
  for (const auto& range : ranges) out.push_back(range.value_or(IsoRange{}));
  return out;
}

class TapeMaker {
 public:
  TapeMaker(const Module& module, const TapeOptions& options) : module_(module), options_(options) {}

  Tapes run() {
    out_.functions.resize(module_.functions.size());
    straighten_large_ones();
    share_budgets();
    shorten();
    for (const Candidate& candidate : candidates_) out_.codes.add(candidate.line);  // before the first is encoded
    for (const Candidate& candidate : candidates_) append(candidate);
    return std::move(out_);
  }

 private:
  struct Candidate {
    std::size_t function;
    StraightLine line;
    TapeCells cells;
  };

  const TimeSplit& split(std::size_t function) const { return module_.functions[function].snippet.time_split(); }
  std::size_t size(std::size_t function) const { return split(function).residual.instructions.size(); }

  void straighten_large_ones() {
    for (std::size_t i = 0; i < module_.functions.size(); ++i) {
      if (size(i) < options_.least_size) continue;
      auto line = snippet::straighten(split(i));
      const std::string why = line ? snippet::cannot_be_tape(*line, split(i).hoisted) : line.error().message;
      if (why.empty()) candidates_.push_back({i, std::move(*line), {}});
      if (!why.empty()) out_.functions[i].note = fmt::format("written out: {}", why);
    }
  }

  void share_budgets() {
    const std::size_t count = std::max<std::size_t>(candidates_.size(), 1);
    options_.most_work /= count;
    options_.most_steps /= count;
    options_.most_cells /= static_cast<std::uint32_t>(count);
  }

  /// What is not worth walking is no candidate any more.
  void shorten() {
    const std::vector<IsoRange> isos = iso_ranges(module_);
    std::erase_if(candidates_, [&](Candidate& candidate) {
      const std::size_t i = candidate.function;
      TapeOptions options = options_;
      options.most_work = std::max(options.most_work, most_work_a_step * candidate.line.steps.size());
      candidate.cells =
          shorten_for_cells(candidate.line, snippet::device_values(split(i), all_times), isos[i], options);
      const double walked = mean_steps(candidate.cells);
      const bool is_written = options_.shorten && size(i) <= options_.most_written &&
                              walked * options_.walking_cost > static_cast<double>(size(i));
      if (is_written)
        out_.functions[i].note =
            fmt::format("written out: {} steps are {:.0f} in a cell", candidate.line.steps.size(), walked);
      return is_written;
    });
  }

  /// Of the cells whose side is not known.
  static double mean_steps(const TapeCells& cells) {
    double steps = 0.0, count = 0.0;
    for (const std::uint32_t content : cells.cells) {
      if (content < 2) continue;
      steps += static_cast<double>(cells.lines[content - 2].steps.size());
      ++count;
    }
    return steps / std::max(count, 1.0);
  }

  void append(const Candidate& candidate) {
    const TapeCells& cells = candidate.cells;
    if (out_.words.empty()) out_.words.resize(2);                               // the empty tapes of known sides
    std::vector<std::uint32_t> places{DMVV_TAPE_POSITIVE, DMVV_TAPE_NEGATIVE};  // of what cells hold
    places.resize(2 + cells.lines.size());
    FunctionTape& function = out_.functions[candidate.function];
    function.is_tape = true;
    function.first_cell = static_cast<std::uint32_t>(out_.cells.size());
    function.cells_a_side = cells.cells_a_side;
    for (const std::uint32_t content : cells.cells) {
      if (content >= 2 && places[content] == 0) {
        places[content] = append(cells.lines[content - 2], split(candidate.function).hoisted);
      }
      out_.cells.push_back(places[content]);
    }
    function.note = describe(candidate.line, function);
  }

  /// The place of the tape.
  std::uint32_t append(const StraightLine& line, std::span<const snippet::Hoisted> hoisted) {
    const Tape tape = *out_.codes.encode(line, hoisted);
    const auto place = static_cast<std::uint32_t>(out_.words.size());
    out_.words.emplace_back(static_cast<std::uint32_t>(tape.instructions.size()), 0u);
    out_.words.insert(out_.words.end(), tape.instructions.begin(), tape.instructions.end());
    out_.registers = std::max(out_.registers, tape.registers);
    return place;
  }

  std::string describe(const StraightLine& whole, const FunctionTape& function) const {
    std::uint64_t undecided = 0, instructions = 0;
    std::uint32_t longest = 0;
    const std::span cells = std::span(out_.cells).subspan(function.first_cell);
    for (const std::uint32_t cell : cells) {
      const std::uint32_t length = out_.words[cell].x;
      undecided += length != 0 ? 1 : 0;
      instructions += length;
      longest = std::max(longest, length);
    }
    return fmt::format(
        "{} steps; of {}^3 cells {:.1f} % are undecided, with {:.0f} instructions each, {} at most", whole.steps.size(),
        function.cells_a_side, 100.0 * static_cast<double>(undecided) / static_cast<double>(cells.size()),
        undecided == 0 ? 0.0 : static_cast<double>(instructions) / static_cast<double>(undecided), longest);
  }

  const Module& module_;
  TapeOptions options_;
  Tapes out_;
  std::vector<Candidate> candidates_;
};

}  // namespace

Tapes make_tapes(const Module& module, const TapeOptions& options) { return TapeMaker(module, options).run(); }

std::string tape_walker(const Tapes& tapes) {
  std::string text = fmt::format("#define DMVV_TAPE_REGISTERS {}u\n", std::bit_ceil(tapes.registers));
  if (tapes.codes.has_third_operand()) text += "#define DMVV_TAPE_THIRD\n";
  text += tapes.codes.glsl();
  text += shader_text::tape;
  return text + "\n";
}

std::string tape_call(const std::string& name, const FunctionTape& tape, std::size_t first_time_value) {
  return fmt::format("float {}(vec3 q) {{\n  return walk_tape(q, {}u, {}.0, {}u);\n}}\n", name, tape.first_cell,
                     tape.cells_a_side, first_time_value);
}

}  // namespace dmvv::compiler
