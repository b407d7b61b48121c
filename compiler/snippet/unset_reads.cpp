#include "compiler/snippet/unset_reads.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "compiler/snippet/probe_points.h"
#include "compiler/snippet/program.h"
#include "compiler/snippet/read_spirv.h"
#include "compiler/spirv/glsl_compiler.h"

namespace dmvv::compiler::snippet {
namespace {

constexpr std::size_t most_variables = 16;  // that are told apart: more have one cause
constexpr std::uint32_t more_points = 200;
constexpr float other_values[] = {777.75f, -777.75f};

struct Witness {
  glm::dvec3 p;
  double t_ms;
};

const std::vector<glm::dvec3>& points() {
  static const std::vector<glm::dvec3> all = [] {
    std::vector<glm::dvec3> result = probe_points();
    for (std::uint32_t i = 101; i <= 100 + more_points; ++i) {
      result.push_back(glm::dvec3(radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5)) * 2.0 - 1.0);
    }
    return result;
  }();
  return all;
}

std::optional<Snippet> read(std::span<const std::uint32_t> spirv, std::span<const std::uint32_t> variables,
                            float value) {
  auto program = read_spirv(with_values(spirv, variables, value));
  if (!program) return std::nullopt;
  return Snippet(std::make_shared<const Program>(std::move(*program)));
}

bool is_same(const Value& a, const Value& b) {
  return a.finished == b.finished && (a.f == b.f || (std::isnan(a.f) && std::isnan(b.f)));
}

/// Where the result changes with what the variables begin with.
std::optional<Witness> find_witness(std::span<const std::uint32_t> spirv, std::span<const std::uint32_t> variables) {
  const auto zero = read(spirv, variables, 0.0f);
  if (!zero) return std::nullopt;
  for (const float value : other_values) {
    const auto other = read(spirv, variables, value);
    if (!other) continue;
    for (const double t : probe_times(zero->uses_time() || other->uses_time())) {
      for (const glm::dvec3& p : points()) {
        if (!is_same(zero->evaluate(p, t), other->evaluate(p, t))) return Witness{p, t};
      }
    }
  }
  return std::nullopt;
}

std::vector<std::uint32_t> ids_of(const std::vector<UnsetVariable>& variables) {
  std::vector<std::uint32_t> ids;
  for (const UnsetVariable& variable : variables) ids.push_back(variable.id);
  return ids;
}

}  // namespace

std::vector<UnsetRead> find_unset_reads(const std::string& glsl, const Literals& literals,
                                        const std::vector<std::uint32_t>& spirv) {
  const std::vector<UnsetVariable> open = find_unset_variables(spirv);
  if (open.empty() || !find_witness(spirv, ids_of(open))) return {};
  const auto lined = literals.put_back(compile_glsl(ShaderStage::vertex, glsl, Lines::kept).spirv);
  std::vector<UnsetVariable> variables = find_unset_variables(lined);
  if (variables.size() > most_variables) variables.resize(most_variables);
  std::vector<UnsetRead> reads;
  for (const UnsetVariable& variable : variables) {
    const auto witness = find_witness(lined, {&variable.id, 1});
    if (witness) reads.push_back({variable, witness->p, witness->t_ms});
  }
  return reads;
}

}  // namespace dmvv::compiler::snippet
