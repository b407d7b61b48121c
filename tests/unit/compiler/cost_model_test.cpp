#include "compiler/plan/cost_model.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/support/scene_table.h"

using namespace dmvv;
using compiler::Codegen;

namespace {

/// A full tree of decisions on grids; every leaf is a region of its own, so no side is pruned.
std::string bushy_tree(int depth, int& next) {
  if (depth == 0) return fmt::format("region='R{}'/>", next++);
  const auto side = [&](const char* name) {
    if (depth == 1) return fmt::format("<{} {}", name, bushy_tree(0, next));
    return fmt::format("<{0}>{1}</{0}>", name, bushy_tree(depth - 1, next));
  };
  const int sdf = depth;
  const std::string positive = side("POSITIVE"), negative = side("NEGATIVE");
  return fmt::format("<SDF name='S{}'>{}{}</SDF>", sdf, positive, negative);
}

compiler::Module bushy_scene(int depth) {
  int leaves = 0;
  const std::string tree = bushy_tree(depth, leaves);
  std::string text = "<MVV><OBJECT name='BUSH'>";
  std::map<std::string, std::string> files;
  for (int i = 1; i <= depth; ++i) {
    text += fmt::format("<SDF name='S{0}' file='s{0}.lxn'/>", i);
    files.emplace(fmt::format("s{}.lxn", i), tests::sphere_lxn(8, 0.1 * i));
  }
  for (int i = 0; i < leaves; ++i) text += fmt::format("<REGION name='R{}' type='color' rgb='1 0 0'/>", i);
  return tests::lowered(text + "<MAPPINGS>" + tree + "</MAPPINGS></OBJECT></MVV>", files);
}

std::string form_of(const compiler::Module& module, const compiler::DeviceCosts& costs,
                    Codegen codegen = Codegen::automatic) {
  compiler::CompileOptions options;
  options.codegen = codegen;
  options.costs = costs;
  return tests::compiled(module, options).statistics.objects.front().form;
}

}  // namespace

TEST_CASE("a bushy tree is walked where all code is executed, and stays code where branches skip") {
  const auto bush = bushy_scene(7);
  CHECK(form_of(bush, compiler::costs_of_cpu()).find("table, ") == 0);
  CHECK(form_of(bush, compiler::costs_of_gpu()) == "specialised");
  CHECK(form_of(bush, compiler::costs_of_cpu(), Codegen::specialised) == "specialised");
  CHECK(form_of(bushy_scene(3), compiler::costs_of_cpu()) == "specialised");
}

TEST_CASE("chains of decisions and objects stay code on either kind of device") {
  const std::map<std::string, std::string> ball{{"ball.lxn", tests::sphere_lxn(8, 0.8)}};
  for (const auto& text : {tests::chain_scene(12, 0.9), tests::deep_tree_scene(20)}) {
    const auto module = tests::lowered(text, ball);
    for (const auto& costs : {compiler::costs_of_cpu(), compiler::costs_of_gpu()}) {
      CHECK(form_of(module, costs).find("specialised") != std::string::npos);
    }
  }
}
