#include "compiler/snippet/snippet.h"

#include <algorithm>

#include "compiler/snippet/device_values.h"
#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/operands.h"
#include "compiler/snippet/time_values.h"

namespace dmvv::compiler::snippet {

Snippet::Snippet(std::shared_ptr<const Program> program)
    : program_(std::move(program)), split_(std::make_shared<const TimeSplit>(split_time(*program_))) {}

const TimeSplit& Snippet::time_split() const { return *split_; }

bool Snippet::uses_time() const {
  return program_->result == Program::t ||
         std::ranges::any_of(program_->instructions, [](const Instruction& instruction) {
           bool reads = false;
           for_operands(instruction, [&](std::size_t k, char letter) {
             reads = reads || (letter != 'a' && instruction.operands[k] == Program::t);
           });
           return reads;
         });
}

std::size_t Snippet::instruction_count() const { return program_->instructions.size(); }

std::uint32_t Snippet::nesting() const { return snippet::nesting(split_->residual.body); }

Value Snippet::evaluate(const glm::dvec3& p, double t_ms) const {
  const auto result = evaluate_point<double>(*program_, {p.x, p.y, p.z, t_ms});
  return {result.f, result.finished};
}

float Snippet::evaluate_single(const glm::vec3& p, float t_ms) const {
  return evaluate_point<float>(*program_, {p.x, p.y, p.z, t_ms}).f;
}

Interval Snippet::evaluate(const Box& p, const Interval& t_ms, Rounding rounding) const {
  const std::array<Interval, Program::input_count> inputs{
      Interval{p.lo.x, p.hi.x}, {p.lo.y, p.hi.y}, {p.lo.z, p.hi.z}, t_ms};
  if (rounding == Rounding::real) return evaluate_box(*program_, inputs, rounding);
  return evaluate_box(split_->residual, inputs, rounding, device_values(*split_, t_ms));
}

struct BoxFunction::Prepared {
  std::shared_ptr<const TimeSplit> split;
  std::vector<BoxValue> hoisted;
};

BoxFunction::BoxFunction(const Snippet& snippet, const Interval& t_ms)
    : prepared_(std::make_shared<Prepared>(Prepared{snippet.split_, device_values(*snippet.split_, t_ms)})) {}

Interval BoxFunction::operator()(const Box& p) const {
  const std::array<Interval, Program::input_count> inputs{
      Interval{p.lo.x, p.hi.x}, {p.lo.y, p.hi.y}, {p.lo.z, p.hi.z}, {0.0, 0.0}};  // the residual does not read t
  return evaluate_box(prepared_->split->residual, inputs, Rounding::float32, prepared_->hoisted);
}

Steepness Snippet::steepness(const Box& p, const Interval& t_ms) const {
  const std::array<Interval, Program::input_count> inputs{
      Interval{p.lo.x, p.hi.x}, {p.lo.y, p.hi.y}, {p.lo.z, p.hi.z}, {0.0, 0.0}};  // the residual does not read t
  return steepness_over(split_->residual, inputs, device_values(*split_, t_ms));
}

Dual Snippet::differentiate(const glm::dvec3& p, double t_ms) const {
  const std::array<DualNumber, Program::input_count> inputs{
      DualNumber(p.x, {1, 0, 0, 0}), {p.y, {0, 1, 0, 0}}, {p.z, {0, 0, 1, 0}}, {t_ms, {0, 0, 0, 1}}};
  const DualNumber f = evaluate_point<DualNumber>(*program_, inputs).f;
  return {f.value, {f.d[0], f.d[1], f.d[2]}, f.d[3]};
}

std::vector<float> Snippet::time_values(double t_ms) const { return snippet::time_values(split_->slots, t_ms); }

std::size_t Snippet::time_value_count() const { return split_->slots.size(); }

}  // namespace dmvv::compiler::snippet
