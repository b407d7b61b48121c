// Real packings, as the examples make them: nothing is lost between the data and the scene, none at borders of index
// cells, and the device answers as the reference does.
//
// DMVV_POINTS in the environment sets how many points are compared; the default takes few, for each costs the reference
// some ten microseconds.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/files.h"
#include "compiler/ir/legend.h"
#include "runtime/runtime.h"
#include "tests/random/points.h"
#include "tests/support/agreement.h"
#include "tests/support/scenes.h"
#include "voml/scene.h"

using namespace dmvv;

namespace {

const compiler::Module& virion() {
  static const compiler::Module module = tests::lowered_file(DMVV_BINARY_DIR "/examples/virion/virion.voml");
  return module;
}

const compiler::Module& mycoplasma() {
  static const compiler::Module module = tests::lowered_file(DMVV_BINARY_DIR "/examples/mycoplasma/mycoplasma.voml");
  return module;
}

/// How often each object is embedded.
std::map<std::string, std::size_t> embeddings(const compiler::Module& module) {
  std::map<std::string, std::size_t> counts;
  for (const compiler::Region& region : module.regions)
    for (const compiler::CandidateGroup& group : region.groups)
      for (const compiler::Candidate& candidate : group.candidates)
        ++counts[module.objects[candidate.object.index].name];
  return counts;
}

/// Ingredients of a packing and how often each stands, by name; `core` is put before those of the innermost
/// compartment.
void count_results(const nlohmann::json& json, const std::string& core, std::map<std::string, std::size_t>& counts) {
  for (const auto& [key, value] : json.items()) {
    if (!value.is_object()) continue;
    if (value.contains("results"))
      counts[core + key] += value["results"].size();
    else
      count_results(value, key == "HIV1_capsid_3j3q_PackInner_0_1_0" ? "CORE_" : core, counts);
  }
}

std::map<std::string, std::string> names_of_kinds() {
  std::map<std::string, std::string> names;
  std::ifstream file(DMVV_SOURCE_DIR "/examples/virion/kinds.csv");
  for (std::string line; std::getline(file, line);) {
    const std::size_t first = line.find(','), second = line.find(',', first + 1);
    if (second != line.npos) names[line.substr(0, first)] = line.substr(first + 1, second - first - 1);
  }
  return names;
}

/// Compares the device with the reference; returns how many answers were certain.
std::size_t compare(const compiler::Module& module, double time_ms) {
  auto device = runtime::Device::create({});
  REQUIRE(device);
  Diagnostics diagnostics;
  auto program = compiler::compile(module, {}, diagnostics);
  REQUIRE_MESSAGE(program, diagnostics.render());
  REQUIRE(compiler::to_spirv(*program, compiler::Source::points));
  auto evaluator = runtime::Evaluator::create(*device, *program);
  REQUIRE(evaluator);
  const char* const wish = std::getenv("DMVV_POINTS");
  const std::size_t count = wish ? std::strtoul(wish, nullptr, 10) : 1000;
  const compiler::Reference reference(module);
  const auto points = tests::random_scenes::draw_points(module, reference, time_ms, 3, count).all;
  const auto answers = evaluator->probe(points, time_ms);
  REQUIRE(answers);
  const auto legend = compiler::legend(module);
  std::size_t certain = 0, wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto expected = reference.evaluate(points[i], time_ms);
    if (!expected.certain) continue;
    ++certain;
    wrong += tests::compare(legend, expected, program->regions, (*answers)[i]).has_value();
  }
  MESSAGE(points.size(), " points, ", certain, " certain, ", wrong, " wrong");
  CHECK(wrong == 0);
  return certain;
}

}  // namespace

TEST_CASE("virion: every protein of the packing stands in the scene, as often as there") {
  std::ifstream file(DMVV_PACKINGS "/hiv1_mature/HIV-1_0.1.6-8_mixed_radii_pdb.json");
  std::map<std::string, std::size_t> results;
  count_results(nlohmann::json::parse(file), "", results);
  const auto names = names_of_kinds();
  const auto counts = embeddings(virion());
  std::size_t all = 0;
  for (const auto& result : results) {
    const std::string& kind = result.first;
    const std::size_t count = result.second;
    CAPTURE(kind);
    if (count == 0) continue;
    REQUIRE(names.contains(kind));
    REQUIRE(counts.contains(names.at(kind)));
    CHECK(counts.at(names.at(kind)) == count);
    all += count;
  }
  CHECK(all == 11681);                         // what the packing's description says
  CHECK(counts.size() == results.size() + 1);  // and what holds the layers
}

TEST_CASE("virion: the capsid's monomers lie within the envelope, none on another") {
  std::ifstream file(DMVV_BINARY_DIR "/examples/virion/packing.json");
  const auto packing = nlohmann::json::parse(file);
  const auto& results = packing["compartments"]["HIV1_capsid_3j3q_PackOuter_0_1_1"]["surface"]["ingredients"]
                               ["HIV1_CA_mono_0_1_0"]["results"];
  std::vector<glm::dvec3> points;
  for (const auto& result : results)
    points.push_back({result[0][0].get<double>(), result[0][1].get<double>(), result[0][2].get<double>()});
  REQUIRE(points.size() == 1356);
  const auto square = [](const glm::dvec3& d) { return d.x * d.x + d.y * d.y + d.z * d.z; };
  double least = 1e9, farthest = 0.0, loneliest = 0.0;
  for (const glm::dvec3& p : points) {
    double nearest = 1e9;
    for (const glm::dvec3& q : points)
      if (&p != &q) nearest = std::min(nearest, square(p - q));
    least = std::min(least, nearest);
    loneliest = std::max(loneliest, nearest);
    farthest = std::max(farthest, square(p));
  }
  CHECK(std::sqrt(least) > 31.0);
  CHECK(std::sqrt(loneliest) < 37.0);
  CHECK(std::sqrt(farthest) < 600.0);
}

TEST_CASE("mycoplasma: every molecule of the model stands in the scene, as often as there, with all its beads") {
  std::ifstream file(DMVV_PACKINGS "/mycoplasma_genitalium_1184/ingredients_1184.tsv");
  const compiler::Module& module = mycoplasma();
  const auto counts = embeddings(module);
  std::map<std::string, std::size_t> beads_of;
  for (const compiler::Object& object : module.objects) {
    const auto* decision = std::get_if<compiler::Decision>(&module.nodes[object.root.index].content);
    if (decision) beads_of[object.name] = module.sdfs[decision->sdf.index].local_from_object.size();
  }
  std::string line;
  std::getline(file, line);
  std::size_t kinds = 0, molecules = 0, beads = 0;
  while (std::getline(file, line)) {
    std::istringstream row(line);
    std::string entity, name;
    std::size_t stands = 0, has = 0;
    row >> entity >> name >> stands >> has;
    name = name.substr(name.rfind('.') + 1);
    CAPTURE(name);
    if (stands == 0) {
      CHECK_FALSE(counts.contains(name));
      continue;
    }
    std::string object = name;  // characters that files do not have
    for (char& c : object)
      if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.') c = '_';
    REQUIRE(counts.contains(object));
    CHECK(counts.at(object) == stands);
    CHECK(beads_of.at(object) == has);
    ++kinds;
    molecules += stands;
    beads += has;
  }
  CHECK(kinds == 570);
  CHECK(molecules == 28245);  // 28,243 and the two nucleic acids
  CHECK(beads == 98803);
}

TEST_CASE("virion: a section is the same with one cell that lists everything: none is lost at borders of cells") {
  auto device = runtime::Device::create({});
  REQUIRE(device);
  runtime::View view;
  view.size_px = {100, 100};
  view.slice = runtime::Plane{{0.3, 0.2, 1.0}, 0.05};
  view.want_regions = true;
  view.time_ms = 700.0;
  std::vector<std::vector<std::uint32_t>> regions;
  for (const bool indexed : {true, false}) {
    compiler::CompileOptions options;
    if (!indexed) options.disabled_passes.push_back("index");
    Diagnostics diagnostics;
    auto program = compiler::compile(virion(), options, diagnostics);
    REQUIRE_MESSAGE(program, diagnostics.render());
    REQUIRE(compiler::to_spirv(*program, compiler::Source::surface));
    auto evaluator = runtime::Evaluator::create(*device, *program);
    REQUIRE(evaluator);
    const auto picture = evaluator->render(view);
    REQUIRE(picture);
    regions.push_back(picture->regions);
  }
  const std::set<std::uint32_t> seen(regions[0].begin(), regions[0].end());
  CHECK(seen.size() > 20);
  CHECK(regions[0] == regions[1]);
}

TEST_CASE("virion: the device answers as the reference, moving") { CHECK(compare(virion(), 1234.5) > 500); }

TEST_CASE("mycoplasma: the device answers as the reference") { CHECK(compare(mycoplasma(), 0.0) > 500); }
