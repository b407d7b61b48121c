// Packings: tables joined, radii by spacing, blends, names and colours of kinds, and what gzip packed.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "authoring/cellpack.h"
#include "authoring/gunzip.h"
#include "authoring/kind_table.h"
#include "compiler/reference/reference.h"
#include "tests/support/gzip.h"
#include "voml/scene.h"

using namespace dmvv;
using namespace dmvv::authoring;

namespace {

PlacementTable table(std::string_view text) {
  Diagnostics diagnostics;
  auto result = parse_placement_table("t", text, {}, diagnostics);
  REQUIRE_MESSAGE(result, diagnostics.render());
  return *result;
}

std::pair<std::optional<KindTable>, std::string> kinds(std::string_view text) {
  Diagnostics diagnostics;
  auto result = parse_kind_table("k", text, diagnostics);
  return {std::move(result), diagnostics.render()};
}

}  // namespace

TEST_CASE("two tables join by kind: beads, rotations, scales; kinds without beads are refused, others counted") {
  // A turn about z: x -> y. Columns as the model of Mycoplasma has them.
  const auto placed = table(
      "entity\tm11\tm12\tm13\tt1\tm21\tm22\tm23\tt2\tm31\tm32\tm33\tt3\n"
      "7\t0\t-1\t0\t10\t1\t0\t0\t20\t0\t0\t1\t30\n"
      "8\t1\t0\t0\t0\t0\t1\t0\t0\t0\t0\t1\t0\n"
      "7\t1\t0\t0\t-10\t0\t1\t0\t0\t0\t0\t1\t0\n");
  const auto beads = table("entity\tx\ty\tz\tradius\n8\t0\t0\t0\t2\n7\t1\t0\t0\t3\n9\t0\t0\t0\t1\n7\t5\t0\t0\t4\n");
  Diagnostics diagnostics;
  const auto joined = join_tables(placed, beads, "b", 0.0, diagnostics);
  REQUIRE_MESSAGE(joined, diagnostics.render());
  CHECK(joined->beads_unused == 1);
  CHECK_FALSE(joined->chose_radii);
  REQUIRE(joined->packing.ingredients.size() == 2);
  const Ingredient& seven = joined->packing.ingredients[0];
  CHECK(seven.name == "7");
  REQUIRE(seven.beads.size() == 2);
  CHECK(seven.beads[1].position == glm::dvec3(5, 0, 0));
  CHECK(seven.beads[1].radius == 4);
  REQUIRE(seven.placements.size() == 2);
  const Placement& turned = seven.placements[0];
  CHECK(turned.position + turned.rotation * seven.beads[1].position == glm::dvec3(10, 25, 30));
  // Along x from -10 + 1 - 3 to 10 + 4 (its radius, for x lies along y there); 0.95 units are half of that.
  CHECK(fit_packing(joined->packing).center.x == doctest::Approx(1.0));

  const auto fewer = table("kind,x,y,z\n7,1,0,0\n");
  CHECK_FALSE(join_tables(placed, fewer, "b", 1.0, diagnostics));
  CHECK(diagnostics.render().find(
            "b: error[E0566]: there is no bead of 1 of the kinds that are placed, the first is '8'") !=
        std::string::npos);
}

TEST_CASE("radii of beads without: a share of the median distance to the nearest, the others' for single ones") {
  const auto placed = table("kind,x,y,z\na,0,0,0\nb,0,0,0\nc,0,0,0\nd,0,0,0\n");
  // a: distances 2 2 3; b: 10 10; c: one bead; d: two at one place.
  const auto beads = table("kind,x,y,z\na,0,0,0\na,2,0,0\na,0,3,0\nb,0,0,0\nb,0,0,10\nc,5,5,5\nd,1,1,1\nd,1,1,1\n");
  Diagnostics diagnostics;
  const auto joined = join_tables(placed, beads, "b", 0.0, diagnostics);
  REQUIRE(joined);
  CHECK(joined->chose_radii);
  const auto& all = joined->packing.ingredients;
  CHECK(all[0].beads[0].radius == doctest::Approx(2 * bead_spacing_share));
  CHECK(all[1].beads[1].radius == doctest::Approx(10 * bead_spacing_share));
  CHECK(all[2].beads[0].radius == doctest::Approx(10 * bead_spacing_share));  // the upper of 2 and 10
  CHECK(all[3].beads[0].radius == doctest::Approx(10 * bead_spacing_share));
  const auto given = join_tables(placed, beads, "b", 1.5, diagnostics);
  CHECK(given->packing.ingredients[0].beads[0].radius == 1.5);
}

TEST_CASE("the median spacing of points is that of a search of all pairs") {
  std::vector<glm::dvec3> points;
  std::uint32_t state = 1;
  const auto next = [&] { return (state = state * 1664525u + 1013904223u) / 4294967296.0; };
  for (int i = 0; i < 601; ++i) points.push_back({next(), 3.0 * next(), next() * next()});
  std::vector<double> nearest;
  for (const auto& p : points) {
    double best = 1e9;
    for (const auto& q : points)
      if (&p != &q)
        best = std::min(best,
                        std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z)));
    nearest.push_back(best);
  }
  std::ranges::sort(nearest);
  CHECK(median_spacing(points) == doctest::Approx(nearest[300]).epsilon(1e-12));
}

TEST_CASE("a blob: the distance of one bead, the exponential smooth minimum of several, within its cube") {
  const auto regions = [](const Ingredient& ingredient, const MoleculeFrame& frame,
                          const std::vector<glm::dvec3>& points) {
    const std::string text = "<MVV>" + blob_object("B", "1 0 0", blob_function(ingredient, frame, "")) + "</MVV>";
    Diagnostics diagnostics;
    auto scene = voml::read_scene("b.voml", memory_files({{"b.voml", text}}), {}, diagnostics);
    REQUIRE_MESSAGE(scene, diagnostics.render());
    const auto module = compiler::lower(std::move(*scene), diagnostics);
    REQUIRE_MESSAGE(module, diagnostics.render());
    const compiler::Reference reference(*module);
    std::vector<bool> inside;
    for (const glm::dvec3& p : points) inside.push_back(reference.evaluate(p).number != 0);
    return inside;
  };
  const Ingredient one{"one", {}, {{{3, 4, 5}, 2.0}}, {}};
  const MoleculeFrame frame = fit_blob(one, 1.0);
  CHECK(frame.center == glm::dvec3(3, 4, 5));
  CHECK(frame.angstrom_per_unit == doctest::Approx(1.02 * 3.0));  // the radius and the motion
  const double r = 2.0 / frame.angstrom_per_unit;
  CHECK(regions(one, frame, {{r - 1e-4, 0, 0}, {r + 1e-4, 0, 0}, {0, -(r - 1e-4), 0}}) ==
        std::vector<bool>{true, false, true});

  // Three balls; in angstrom, the blend is -log(sum exp(s (r - d))) / s with s = 5 / mean radius, unless that is too
  // steep.
  const Ingredient three{"three", {}, {{{0, 0, 0}, 2.0}, {{3, 0, 0}, 1.0}, {{0, 2.5, 0}, 1.5}}, {}};
  const MoleculeFrame own = fit_blob(three, 0.0);
  const double s = std::min(24.0 / own.angstrom_per_unit, 5.0 / 1.5);
  const auto value = [&](const glm::dvec3& p) {
    double sum = 0;
    for (const Bead& bead : three.beads) {
      const glm::dvec3 d = p - bead.position;
      sum += std::exp(s * (bead.radius - std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z)));
    }
    return -std::log(sum) / s;
  };
  std::vector<glm::dvec3> points;
  std::vector<bool> expected;
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec3 q(std::fmod(i * 0.7548776662, 1.0) * 2 - 1, std::fmod(i * 0.5698402910, 1.0) * 2 - 1,
                       std::fmod(i * 0.3819660113, 1.0) * 2 - 1);
    const double v = value(own.center + own.angstrom_per_unit * q);
    if (std::abs(v) < 1e-3) continue;  // the text has five decimals
    points.push_back(q);
    expected.push_back(v < 0.0);
  }
  CHECK(regions(three, own, points) == expected);
  // Nothing of it reaches the cube's faces.
  for (int i = 0; i < 400; ++i) {
    glm::dvec3 q(std::fmod(i * 0.7548776662, 1.0) * 2 - 1, std::fmod(i * 0.5698402910, 1.0) * 2 - 1, 1.0);
    for (int axis = 0; axis < 3; ++axis) {
      std::swap(q[2], q[axis]);
      CHECK(value(own.center + own.angstrom_per_unit * q) > 0.0);
      CHECK(value(own.center - own.angstrom_per_unit * q) > 0.0);
    }
  }
}

TEST_CASE("the table of kinds: names, colours and radii; faults at their place") {
  const auto reading = kinds("# of a cell\nentity,instances,name,rgb,radius\n7,3,POLYMERASE,#ff8000,\n8,2,,,2.5\n");
  const auto& table = reading.first;
  REQUIRE_MESSAGE(table, reading.second);
  CHECK(table->at("7").name == "POLYMERASE");
  CHECK(table->at("7").rgb == "1.0000 0.5020 0.0000");
  CHECK(table->at("7").radius == 0.0);
  CHECK(table->at("8").name.empty());
  CHECK(table->at("8").radius == 2.5);
  const auto quoted =
      kinds("\xef\xbb\xbf\"kind\";name;\"rgb\"\r\n\"7\";\"RNA \"\"P\"\"; 3,5\";#ff8000\r\n;;\r\n# none\r\n");
  REQUIRE_MESSAGE(quoted.first, quoted.second);
  CHECK(quoted.first->at("7").name == "RNA \"P\"; 3,5");
  CHECK(quoted.first->size() == 1);
  CHECK(kinds("kind\tname\na\t\"x\n").second.starts_with("k:2:3: error[E0564]: a quote that is not closed"));
  CHECK(kinds("\"kind").second.find("1 error\n") != std::string::npos);  // no table is empty as a consequence
  CHECK(kinds("kind;radius\na;2,5\n").second.starts_with("k:2:3: error[E0564]: '2,5' is no radius; write 2.5"));
  const std::string names = "kind\trgb\n";
  CHECK(kinds(names + "a\t#12345\n").second.starts_with("k:2:3: error[E0564]: '#12345' is no colour"));
  CHECK(kinds(names + "a\t#12345g\n").second.starts_with("k:2:3: error[E0564]"));
  CHECK(kinds(names + "a\n").second.starts_with("k:2:1: error[E0564]: the row has 1 fields, the first one 2"));
  CHECK(kinds(names + "a\t#000000\na\t#000000\n").second.starts_with("k:3:1: error[E0564]: the kind 'a' stands twice"));
  CHECK(kinds("kind,radius\na,-1\n").second.starts_with("k:2:3: error[E0564]: '-1' is no radius"));
  CHECK(kinds("kind,count\n").second.starts_with("k:1:1: error[E0565]"));
  CHECK(kinds("name,rgb\n").second.starts_with("k:1:1: error[E0565]"));
  CHECK(kinds("kind,entity,name\n").second.starts_with("k:1:6: error[E0565]: the column 'entity' stands twice"));
  CHECK(kinds("").second.find("E0565") != std::string::npos);
}

TEST_CASE("gzip: unpacked, several members too; cut short, damaged, and too large are refused") {
  std::string text;
  for (int i = 0; i < 200000; ++i) text += fmt::format("{} ", (i % 1000) * (i % 1000) % 1000);
  const std::string packed = tests::gzip(text);
  CHECK(is_gzip(packed));
  CHECK_FALSE(is_gzip(text));
  CHECK(gunzip(packed).value() == text);
  CHECK(gunzip(packed + tests::gzip("more")).value() == text + "more");
  CHECK(gunzip(tests::gzip("")).value().empty());
  for (const std::size_t length : {std::size_t{2}, std::size_t{9}, packed.size() / 2, packed.size() - 1}) {
    const auto cut = gunzip(std::string_view(packed).substr(0, length));
    REQUIRE_FALSE(cut);
    CHECK(cut.error().fault == Fault::input);
    CHECK(cut.error().message.find("ends too soon") != std::string::npos);
  }
  std::string damaged = packed;
  damaged[packed.size() - 6] = static_cast<char>(damaged[packed.size() - 6] ^ 1);  // the sum
  CHECK(gunzip(damaged).error().message.find("is damaged") != std::string::npos);
  CHECK_FALSE(gunzip(packed + "x"));
  const auto bomb = gunzip(tests::gzip(std::string(1 << 20, '\0')), 1 << 16);
  REQUIRE_FALSE(bomb);
  CHECK(bomb.error().message.find("hold more than 65536 bytes") != std::string::npos);
  CHECK(gunzip(tests::gzip(std::string(1 << 16, '\0')), 1 << 16).value().size() == 1 << 16);
}
