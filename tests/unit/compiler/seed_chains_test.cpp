// Which SDFs share a search.
#include "compiler/passes/seed_chains.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "compiler/compile.h"
#include "tests/support/scene_table.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::compiler;

namespace {

const tests::Files files{{"ball.lxn", tests::sphere_lxn(8, 0.8)},
                         {"ball2.lxn", tests::sphere_lxn(8, 0.7)},
                         {"p.txt", "0 0 0\n0.5 0 0\n"},
                         {"q.txt", "0 0.5 0\n"}};

std::string seeded(const std::string& name, const std::string& file = "ball.lxn", const std::string& more = {}) {
  return fmt::format("<SDF name='{}' type='seeding' file='{}' seedFile='{}' {}/>", name, file,
                     name < "C" ? "p.txt" : "q.txt", more);
}

std::string decision(const std::string& sdf, const std::string& positive,
                     const std::string& negative = "<REGION name='IN'/>") {
  return fmt::format("<SDF name='{}'><POSITIVE>{}</POSITIVE><NEGATIVE>{}</NEGATIVE></SDF>", sdf, positive, negative);
}

/// The chains by the names of their SDFs: "A B C; D E".
std::string chains_of(const std::string& sdfs, const std::string& tree) {
  const Module module =
      tests::lowered("<MVV><OBJECT name='O'>" + sdfs +
                         "<REGION name='IN' type='color' rgb='1 0 0'/><REGION name='OUT' type='color' rgb='0 0 1'/>"
                         "<MAPPINGS name='O'>" +
                         tree + "</MAPPINGS></OBJECT></MVV>",
                     files);
  std::string text;
  for (const SeedChain& chain : find_seed_chains(module)) {
    if (!text.empty()) text += "; ";
    for (std::size_t i = 0; i < chain.size(); ++i) text += (i == 0 ? "" : " ") + at(module.sdfs, chain[i]).name;
  }
  return text;
}

const std::string out = "<REGION name='OUT'/>";

}  // namespace

TEST_CASE("seeds of one source along the positive sides are a chain") {
  const std::string abc = seeded("A") + seeded("B") + seeded("C");
  CHECK(chains_of(abc, decision("A", decision("B", decision("C", out)))) == "A B C");
  CHECK(chains_of(abc, decision("C", decision("A", out))) == "C A");
  CHECK(chains_of(abc, decision("A", out)).empty());
  CHECK(chains_of(abc, decision("A", out, decision("B", decision("C", out)))) == "B C");
}

TEST_CASE("what differs ends a chain") {
  const std::string tree = decision("A", decision("B", decision("C", decision("D", out))));
  const auto with_c = [&](const std::string& c) {
    return chains_of(seeded("A") + seeded("B") + c + seeded("D"), tree);
  };
  CHECK(with_c(seeded("C")) == "A B C D");
  CHECK(with_c(seeded("C", "ball2.lxn")) == "A B");
  CHECK(with_c(seeded("C", "ball.lxn", "offset='0.1'")) == "A B");
  CHECK(with_c(seeded("C", "ball.lxn", "index='1 1 1'")) == "A B");
  CHECK(with_c(seeded("C", "ball.lxn", "index='2 3 4'")) == "A B C D");
  CHECK(with_c("<SDF name='C' file='ball.lxn'/>") == "A B");
  CHECK(with_c("<SDF name='C' type='tiling' file='ball.lxn'/>") == "A B");
}

TEST_CASE("an SDF that is asked in two places is in no chain") {
  const std::string abc = seeded("A") + seeded("B") + seeded("C");
  CHECK(chains_of(abc, decision("A", decision("B", decision("C", out)), decision("C", out))) == "A B");
}

TEST_CASE("code searches chains at once; the walker has none") {
  const tests::SceneCase& scene = tests::conformance_scene("seeds of a shape in chains of decisions");
  const Module module = tests::lowered(scene.text, scene.files);
  CompileOptions options;
  options.codegen = Codegen::specialised;
  const Program code = tests::compiled(module, options);
  CHECK(code.statistics.shared.seed_chains == 4);  // GRAINS, TURNED, and before and behind S9 of MANY
  CHECK(code.statistics.shared.chained_sdfs == 4 + 3 + 9 + 8);
  const std::string& text = code.shader("pixels").glsl;
  CHECK(text.find("first_negative = first_of_") != std::string::npos);

  options.disabled_passes = {"chain-seeds"};
  CHECK(tests::compiled(module, options).statistics.shared.seed_chains == 0);
  options = {};
  options.codegen = Codegen::table;
  CHECK(tests::compiled(module, options).statistics.shared.seed_chains == 0);
  options.codegen = Codegen::specialised;
  options.inlined_line_budget = 200;  // too few for all: the walker is called as well
  const Program mixed = tests::compiled(module, options);
  CHECK(mixed.statistics.shared.seed_chains == 0);
}
