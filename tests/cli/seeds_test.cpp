// dmvv seeds: from a molecule's file to seed files and a scene.
#include <doctest/doctest.h>

#include <algorithm>

#include "tests/cli/program.h"
#include "tests/support/gzip.h"

using namespace dmvv::tests;

namespace {

// Carbon and oxygen 2 A apart along x; a water.
const char* const carbonyl =
    "ATOM      1  C   GLY A   1      10.000   0.000   0.000  1.00 20.00           C  \n"
    "ATOM      2  O   GLY A   1      12.000   0.000   0.000  1.00 20.00           O  \n"
    "HETATM    3  O   HOH A   2      40.000   0.000   0.000  1.00 20.00           O  \n"
    "END\n";

// Two ingredients in two compartments. A turns x to y at (10, 0, 0): its bead (1, 0, 0) comes to (10, 1, 0).
const char* const packing = R"({"recipe": {"name": "two"}, "compartments": {
  "shell": {"surface": {"ingredients": {"A b": {"results": [[[10, 0, 0], [0.7071067811865476, 0, 0, 0.7071067811865476]],
                                                            [[-10, 0, 0], [1, 0, 0, 0]]],
                                        "positions": [[[1, 0, 0], [3, 0, 0]]], "radii": [[2, 1.5]]}}}},
  "core": {"interior": {"ingredients": {"C": {"results": [[[0, 0, 0], [1, 0, 0, 0]]], "positions": [[[0, 0, 0]]],
                                              "radii": [[3]]},
                                        "none": {"results": []}}}}}})";

}  // namespace

TEST_CASE("seeds by element in fractions of the edge, the scale reported, a scene that holds no mistake") {
  const Folder folder;
  const Run run = run_dmvv({"seeds", folder.write("co.pdb", carbonyl), "-o", folder.file("co"), "--voml"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.err.empty());
  CHECK(run.out.find("2 atoms (C 1, O 1)") != std::string::npos);
  CHECK(run.out.find("left out: 1 of water") != std::string::npos);
  // From 10 - 1.70 to 12 + 1.52: half of 5.22 is 0.95 units.
  CHECK(run.out.find("1 unit = 2.747 A, the middle is 10.910 0.000 0.000") != std::string::npos);
  CHECK(folder.read("co_C.txt") == "-0.1656130 0.0000000 0.0000000\n");       // (10 - 10.91) / (2 * 2.747368)
  CHECK(folder.read("co_O.txt") == "0.1983716 0.0000000 0.0000000\n");        // (12 - 10.91) / (2 * 2.747368)
  CHECK(folder.read("co_C_scale.txt") == "0.6875266 0.6875266 0.6875266\n");  // 1.70 / (0.9 * 2.747368)
  CHECK(folder.read("co_O_scale.txt") == "0.6147297 0.6147297 0.6147297\n");  // 1.52 / (0.9 * 2.747368)
  const Run check = run_dmvv({"check", "--strict", folder.file("co.voml")});
  CAPTURE(check.err);
  CHECK(check.exit_code == 0);
}

TEST_CASE("--water keeps it, without --voml there is no scene, --quiet says nothing") {
  const Folder folder;
  const Run run = run_dmvv({"seeds", folder.write("co.pdb", carbonyl), "-o", folder.file("co"), "--water", "--quiet"});
  CHECK(run.exit_code == 0);
  CHECK(run.out.empty());
  const std::string oxygens = folder.read("co_O.txt");
  CHECK(std::count(oxygens.begin(), oxygens.end(), '\n') == 2);
  CHECK(folder.listing().size() == 5);
}

TEST_CASE("faults: place and exit code; nothing is written") {
  const Folder folder;
  std::string text = carbonyl;
  text.replace(text.find("12.000"), 6, "12,000");
  const Run fault = run_dmvv({"seeds", folder.write("co.pdb", text), "-o", folder.file("co"), "--voml"});
  CHECK(fault.exit_code == 1);
  CHECK(fault.err.find("co.pdb:2:31: error[E0560]: the coordinate x is '  12,000'") != std::string::npos);
  CHECK(folder.listing().size() == 1);
  CHECK(run_dmvv({"seeds", folder.file("absent.pdb"), "-o", folder.file("co")}).exit_code == 1);
  const std::string good = folder.write("good.pdb", carbonyl);
  CHECK(run_dmvv({"seeds", good, "-o", folder.file("no/co")}).exit_code == 1);
  CHECK(run_dmvv({"seeds", good, "-o", folder.file("")}).exit_code == 2);
  CHECK(run_dmvv({"seeds", good}).exit_code == 2);
  CHECK(folder.listing().size() == 2);
}

TEST_CASE("a table: files by kind, a scene that holds no mistake, the scale and repairs reported") {
  const Folder folder;
  // Cubes of half-edge 1 at -9 and 9 along x: from -10 to 10, 0.95 units are 10.
  const std::string table = folder.write("t.csv",
                                         "x,y,z,qw,qx,qy,qz,scale,kind\n"
                                         "-9,0,0,1,0,0,0,1,rod\n9,0,0,0.7071,0,0,0.7071,1,grain of sand\n");
  const Run run = run_dmvv({"seeds", table, "-o", folder.file("t"), "--voml"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("2 placements (rod 1, grain_of_sand 1)") != std::string::npos);
  CHECK(run.out.find("repaired 1 rotation, not quite orthogonal") != std::string::npos);
  CHECK(folder.read("t_rod.txt") == "-0.427500000 0.000000000 0.000000000\n");  // -9 / 2 * 0.095
  CHECK(folder.read("t_rod_scale.txt") == "0.095 0.095 0.095\n");
  CHECK(folder.read("t_grain_of_sand_rotate.txt").find(" 90.0000000\n") != std::string::npos);
  const Run check = run_dmvv({"check", "--strict", folder.file("t.voml")});
  CAPTURE(check.err);
  CHECK(check.exit_code == 0);
  const Run fault = run_dmvv({"seeds", folder.write("f.csv", "x,y,z\n1,2,x\n"), "-o", folder.file("f")});
  CHECK(fault.exit_code == 1);
  CHECK(fault.err.find("f.csv:2:5: error[E0564]") != std::string::npos);
  CHECK(run_dmvv({"seeds", table, "-o", folder.file("u"), "--radius", "-1"}).exit_code == 2);
  CHECK(run_dmvv({"seeds", table, "-o", folder.file("u"), "--format", "molecule", "--columns", "x"}).exit_code == 2);
}

TEST_CASE("--assembly: the unit embedded once an operator, a list of assemblies, an unknown one") {
  const Folder folder;
  const std::string pdb = folder.write("co.pdb", std::string("REMARK 350 BIOMOLECULE: 1\n"
                                                             "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
                                                             "REMARK 350   BIOMT1   1  1.0  0.0  0.0   0.0\n"
                                                             "REMARK 350   BIOMT2   1  0.0  1.0  0.0   0.0\n"
                                                             "REMARK 350   BIOMT3   1  0.0  0.0  1.0   0.0\n"
                                                             "REMARK 350   BIOMT1   2  0.0 -1.0  0.0   0.0\n"
                                                             "REMARK 350   BIOMT2   2  1.0  0.0  0.0   0.0\n"
                                                             "REMARK 350   BIOMT3   2  0.0  0.0  1.0   0.0\n") +
                                                     carbonyl);
  const Run list = run_dmvv({"seeds", pdb, "--assembly", "list"});
  CHECK(list.exit_code == 0);
  CHECK(list.out.find("  1: 2 operators of chains A\n") != std::string::npos);
  const Run run = run_dmvv({"seeds", pdb, "-o", folder.file("a"), "--assembly", "1", "--voml"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("4 atoms (2 operators of chains A)") != std::string::npos);
  // Both axes from -1.70 to 13.52: half of that is 0.95 units.
  CHECK(run.out.find("1 unit = 8.011 A, the middle is 5.910 5.910 0.000") != std::string::npos);
  CHECK(folder.read("a_UNIT_rotate.txt").ends_with(" 90.0000000\n"));
  const Run check = run_dmvv({"check", "--strict", folder.file("a.voml")});
  CAPTURE(check.err);
  CHECK(check.exit_code == 0);
  const Run unknown = run_dmvv({"seeds", pdb, "-o", folder.file("b"), "--assembly", "9"});
  CHECK(unknown.exit_code == 1);
  CHECK(unknown.err.find("co.pdb: error[E0563]: there is no assembly '9'") != std::string::npos);
}

TEST_CASE("elements that are not known: one warning, the atoms left out; --quiet keeps it back") {
  const Folder folder;
  std::string text = carbonyl;
  text.replace(text.find("C  \n"), 1, "X");
  const std::string pdb = folder.write("co.pdb", text);
  const Run run = run_dmvv({"seeds", pdb, "-o", folder.file("co")});
  CHECK(run.exit_code == 0);
  CHECK(run.err.find("co.pdb:1:78: warning[W0580]: 1 atom is left out, because no such element is known: 'X' 1") !=
        std::string::npos);
  CHECK(run.out.find("1 atom (O 1)") != std::string::npos);
  CHECK(run_dmvv({"seeds", pdb, "-o", folder.file("co"), "--quiet"}).err.empty());
}

TEST_CASE("a table with quotes within quotes: the kind's name in files and scene") {
  const Folder folder;
  const std::string table = folder.write("t.csv", "x,y,z,kind\n1,2,3,\"a \"\"big\"\" one\"\n4,5,6,b\n");
  const Run run = run_dmvv({"seeds", table, "-o", folder.file("t"), "--voml"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("2 placements (a__big__one 1, b 1)") != std::string::npos);
  CHECK(run_dmvv({"check", "--strict", folder.file("t.voml")}).exit_code == 0);
}

TEST_CASE("a result of cellPACK without beads: balls of the recipe's radius, of --kinds or of --radius") {
  const Folder folder;
  const auto file = [&](const std::string& name, const std::string& radius) {
    return folder.write(name, R"({"recipe":{"name":"root"},"cytoplasme":{"ingredients":{"Ball":{"name":"Ball",)" +
                                  radius + R"("results":[[[100,0,0],[1,0,0,0]],[[-100,0,0],[1,0,0,0]]]}}}})");
  };
  const std::string told = file("told.json", R"("radius":25,"encapsulatingRadius":25,)"), none = file("none.json", "");
  const Run run = run_dmvv({"seeds", told, "-o", folder.file("a"), "--voml"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("2 placements of 1 ingredient with 1 bead\n") != std::string::npos);
  CHECK(run.out.find("1 ingredient without beads: one ball each") != std::string::npos);
  // Along x from -125 to 125: 125 is 0.95 units.
  CHECK(run.out.find("1 unit = 131.6 A") != std::string::npos);
  CHECK(run_dmvv({"check", "--strict", folder.file("a.voml")}).exit_code == 0);
  const Run refused = run_dmvv({"seeds", none, "-o", folder.file("b")});
  CHECK(refused.exit_code == 1);
  CHECK(refused.err.find("none.json:1:63: error[E0568]: 'Ball' has no radii of beads") != std::string::npos);
  const std::string kinds = folder.write("kinds.csv", "kind,radius\nBall,25\n");
  for (const auto& [option, value] : {std::pair<std::string, std::string>{"--radius", "25"}, {"--kinds", kinds}})
    CHECK(run_dmvv({"seeds", none, "-o", folder.file("b"), option, value}).out.find("1 unit = 131.6 A") !=
          std::string::npos);
  CHECK(run_dmvv({"seeds", folder.write("co.pdb", carbonyl), "-o", folder.file("c"), "--radius", "1"}).exit_code == 2);
}

TEST_CASE("a result of cellPACK: beads, placements, and the region of each ingredient where its bead is") {
  const Folder folder;
  const std::string json = folder.write("two.json", packing);
  const Run run = run_dmvv({"seeds", json, "-o", folder.file("two"), "--voml"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.err.empty());
  CHECK(run.out.find("3 placements of 2 ingredients with 3 beads\n") != std::string::npos);
  // Along x from -10 + 1 - 2 to 10 + 2, the longest side: half of 23 is 0.95 units.
  CHECK(run.out.find("1 unit = 12.11 A, the middle is 0.500 0.750 0.000\n") != std::string::npos);
  const std::string rotates = folder.read("two_A_b_rotate.txt");
  CHECK(rotates.find(" 90.0000000\n") != std::string::npos);
  CHECK(std::count(rotates.begin(), rotates.end(), '\n') == 2);
  const std::string beads = folder.read("two_A_b_bead.txt");
  CHECK(std::count(beads.begin(), beads.end(), '\n') == 2);
  const Run check = run_dmvv({"check", "--strict", folder.file("two.voml")});
  CAPTURE(check.err);
  CHECK(check.exit_code == 0);
  // y reaches from -3 (C) to 3 + 1.5 + 1 (A turned).
  const auto region_at = [&](const std::string& scene, const std::string& point, const std::string& root = "ALL") {
    return run_dmvv({"probe", folder.file(scene), "--root", root, "--backend", "reference", "--json", "--point", point})
        .out;
  };
  const std::string at_c = "-0.0413 -0.0206 0", at_a = "0.7845 0.0619 0";  // (0, 0.5, 0), (10, 1.5, 0)
  CHECK(region_at("two.voml", at_c).find("/C:R.BEADS\"") != std::string::npos);
  CHECK(region_at("two.voml", at_a).find("/A_b:R.BEADS\"") != std::string::npos);
  CHECK(region_at("two.voml", "0.4 0 0").find("\"path\":null") != std::string::npos);
  CHECK(region_at("two.voml", "0.4 0 0", "FILLED").find("R.BETWEEN") != std::string::npos);

  // Blended, coloured by a table, moving, from a packed file.
  const std::string kinds = folder.write("kinds.csv", "kind,name,rgb\nA b,SPIKE,#ff0000\n");
  const Run blended = run_dmvv({"seeds", folder.write("two.json.gz", dmvv::tests::gzip(packing)), "-o",
                                folder.file("b"), "--voml", "--blend", "--jiggle", "0.5", "--kinds", kinds});
  CAPTURE(blended.err);
  REQUIRE(blended.exit_code == 0);
  CHECK(region_at("b.voml", "0.77 0.03 0").find("/SPIKE:R.SPIKE\",\"region\":\"R.SPIKE\",\"rgb\":[1,0,0]") !=
        std::string::npos);
  CHECK(run_dmvv({"check", "--strict", folder.file("b.voml")}).exit_code == 0);
  CHECK_FALSE(std::ranges::count(folder.listing(), std::string("b_SPIKE_bead.txt")));  // the beads are in the function

  const Run fault = run_dmvv({"seeds", folder.write("bad.cpr", "{\n\"a\": x}"), "-o", folder.file("f")});
  CHECK(fault.exit_code == 1);
  CHECK(fault.err.find("bad.cpr:2:6: error[E0568]") != std::string::npos);
  const Run cut = run_dmvv(
      {"seeds", folder.write("cut.json.gz", dmvv::tests::gzip(packing).substr(0, 60)), "-o", folder.file("f")});
  CHECK(cut.exit_code == 1);
  CHECK(cut.err.find("cut.json.gz: the compressed data ends too soon at byte 60") != std::string::npos);
  CHECK(run_dmvv({"seeds", json, "-o", folder.file("f"), "--jiggle", "1"}).exit_code == 2);
  CHECK(run_dmvv({"seeds", json, "-o", folder.file("f"), "--beads", kinds}).exit_code == 2);
}

TEST_CASE("--beads: a table of beads beside one of placements; kinds without beads are named") {
  const Folder folder;
  const std::string placed =
      folder.write("placed.tsv.gz", dmvv::tests::gzip("entity\tt1\tt2\tt3\n7\t-10\t0\t0\n7\t10\t0\t0\n8\t0\t0\t0\n"));
  const std::string beads =
      folder.write("beads.tsv", "entity\tx\ty\tz\n7\t-1\t0\t0\n7\t1\t0\t0\n8\t0\t0\t0\n9\t0\t0\t0\n");
  const Run run = run_dmvv({"seeds", placed, "--beads", beads, "-o", folder.file("cell"), "--voml"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("3 placements of 2 ingredients with 3 beads\n") != std::string::npos);
  // Radii 0.866 * 2: from -12.732 to 12.732.
  CHECK(run.out.find("1 unit = 13.4 A, the middle is 0.000 0.000 0.000\n") != std::string::npos);
  CHECK(run.out.find("left out: 1 kind with beads that stand nowhere") != std::string::npos);
  CHECK(run.out.find("no radii: each is 0.866 of the median distance") != std::string::npos);
  CHECK(run_dmvv({"check", "--strict", folder.file("cell.voml")}).exit_code == 0);
  const Run given = run_dmvv({"seeds", placed, "--beads", beads, "--radius", "1", "-o", folder.file("r")});
  CHECK(given.out.find("1 unit = 12.63 A") != std::string::npos);  // 12 / 0.95
  const std::string few = folder.write("few.tsv", "entity\tx\ty\tz\n7\t-1\t0\t0\n");
  const Run fault = run_dmvv({"seeds", placed, "--beads", few, "-o", folder.file("f")});
  CHECK(fault.exit_code == 1);
  CHECK(fault.err.find("few.tsv: error[E0566]: there is no bead of 1 of the kinds that are placed, the first is '8'") !=
        std::string::npos);
}
