// Placements: rotations there and back, tables as spec/seeds.md says, and what a scene makes of the files.
#include "authoring/placements.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <set>

#include "authoring/cellpack.h"
#include "authoring/placement_table.h"
#include "voml/scene.h"

using namespace dmvv;
using namespace dmvv::authoring;

namespace {

double distance(const glm::dmat3& a, const glm::dmat3& b) {
  double largest = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(a[i][j] - b[i][j]));
  return largest;
}

/// Rodrigues' formula: about a unit axis, by an angle in radians.
glm::dmat3 about(const glm::dvec3& axis, double angle) {
  glm::dmat3 result;
  for (int column = 0; column < 3; ++column) {
    glm::dvec3 v(0);
    v[column] = 1;
    result[column] =
        v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) + axis * glm::dot(axis, v) * (1 - std::cos(angle));
  }
  return result;
}

/// spec/voml.md, Space: x is turned first, then y, then z.
glm::dmat3 composed(const glm::dvec3& deg) {
  const glm::dvec3 a = deg * (std::acos(-1.0) / 180);
  return about({0, 0, 1}, a.z) * about({0, 1, 0}, a.y) * about({1, 0, 0}, a.x);
}

struct Reading {
  std::optional<PlacementTable> table;
  std::string messages;
};

Reading read(std::string_view text, const std::string& columns = {}) {
  Diagnostics diagnostics;
  Reading result;
  result.table = parse_placement_table("t", text, {columns}, diagnostics);
  result.messages = diagnostics.render();
  return result;
}

const Placement& only(const Reading& reading) {
  REQUIRE_MESSAGE(reading.table, reading.messages);
  REQUIRE(reading.table->kinds.size() == 1);
  REQUIRE(reading.table->kinds[0].placements.size() == 1);
  return reading.table->kinds[0].placements[0];
}

void check_refused(std::string_view text, std::string_view place_and_code, const std::string& columns = {}) {
  const Reading reading = read(text, columns);
  CHECK_FALSE(reading.table);
  CHECK_MESSAGE(reading.messages.starts_with(place_and_code), reading.messages);
}

std::vector<glm::dmat3> rotations() {
  std::vector<glm::dmat3> result;
  for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}, {1, 2, -3}, {-5, 0.1, 1}, {1, 1, 1}})
    for (const double angle : {0.0, 1e-9, 0.3, 1.5707963267948966, 2.0, 3.141592653589793, -1.0, -1.5707963267948966})
      result.push_back(about(glm::normalize(axis), angle));
  return result;
}

}  // namespace

TEST_CASE("angles of a rotation compose to it, also where y is 90 degrees") {
  for (const glm::dmat3& r : rotations()) {
    CHECK(distance(composed(euler_angles_deg(r)), r) < 1e-14);
    CHECK(distance(euler_rotation(euler_angles_deg(r)), r) < 1e-14);
  }
  CHECK(distance(euler_rotation({10, 20, 30}), composed({10, 20, 30})) < 1e-15);
}

TEST_CASE("the nearest rotation: R of R times a symmetric stretch; mirrors and the hopeless are none") {
  const glm::dmat3 stretch(1.01, 0.004, -0.002, 0.004, 0.99, 0.003, -0.002, 0.003, 1.02);
  for (const glm::dmat3& r : rotations()) {
    const auto nearest = nearest_rotation(r * stretch);
    REQUIRE(nearest);
    CHECK(distance(nearest->matrix, r) < 1e-14);
    CHECK(nearest->fault == doctest::Approx(1.02 * 1.02 - 1).epsilon(0.01));
    CHECK(nearest_rotation(r)->fault < exact_rotation);
    CHECK_FALSE(nearest_rotation(-r));
    CHECK_FALSE(nearest_rotation(r * 1.1));
  }
  CHECK_FALSE(nearest_rotation(glm::dmat3(0.0)));
}

TEST_CASE("a quaternion turns by twice its angle about its axis") {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, -2, 0.5));
  const double a = 0.4;
  const glm::dvec3 v = axis * std::sin(a);
  CHECK(distance(quaternion_rotation(std::cos(a), v.x, v.y, v.z)->matrix, about(axis, 2 * a)) < 1e-15);
  const auto longer = quaternion_rotation(1.01 * std::cos(a), 1.01 * v.x, 1.01 * v.y, 1.01 * v.z);
  CHECK(distance(longer->matrix, about(axis, 2 * a)) < 1e-15);
  CHECK(longer->fault > exact_rotation);
  CHECK_FALSE(quaternion_rotation(0, 0, 0, 0));
  CHECK_FALSE(quaternion_rotation(2, 0, 0, 0));
}

TEST_CASE("tables: the same placement in every form and separation") {
  const glm::dmat3 quarter = about({0, 0, 1}, std::acos(0.0));  // x -> y
  const double h = std::sqrt(0.5);
  for (const Reading& reading :
       {read(fmt::format("# grains\nX,Y,Z,qx,qy,qz,qw,scale\n1,2,3,0,0,{0},{0},4\n", h)),
        read(fmt::format("qw\tqz\tqx\tqy\tnote\tz\ty\tx\tscale\r\n{0}\t{0}\t0\t0\ta b\t3\t2\t1\t4\r\n", h)),
        read("x y z rx ry rz sx sy sz # all\n\n  1 2  3 0 0 90 4 4 4  # one\n"),
        read("m00;m01;m02;m10;m11;m12;m20;m21;m22;x;y;z;scale\n0;-1;0;1;0;0;0;0;1;1;2;3;4"),
        read("m11 m12 m13 x m21 m22 m23 y m31 m32 m33 z scale\n0 -1 0 1 1 0 0 2 0 0 1 3 4\n"),
        read("1 2 3 0 0 90 4", "x,y,z,rx,ry,rz,scale"),
        read("a b c d e f g\n1 2 3 0 0 90 4", "x,y,z,rx,ry,rz,scale")}) {
    const Placement& p = only(reading);
    CHECK(p.position == glm::dvec3(1, 2, 3));
    CHECK(p.scale == glm::dvec3(4));
    CHECK(distance(p.rotation, quarter) < 1e-15);
    CHECK(reading.table->has_rotations);
    CHECK(reading.table->has_scales);
    CHECK(reading.table->repaired == 0);
  }
}

TEST_CASE("angles that are left out are 0") {
  CHECK(distance(only(read("x,y,z,ry\n1,2,3,30\n")).rotation, composed({0, 30, 0})) < 1e-14);
  CHECK(distance(only(read("x,rz,y,z,rx\n1,90,2,3,40\n")).rotation, composed({40, 0, 90})) < 1e-14);
}

TEST_CASE("tables: without a header, three numbers and a fourth that is a scale or a kind") {
  CHECK_FALSE(read("1 2 3\n").table->has_scales);
  CHECK(only(read("1 2 3 4\n")).scale == glm::dvec3(4));
  const Reading kinds = read("1,2,3,b\n4,5,6,\"a, #1\"\n7,8,9,b\n");
  REQUIRE_MESSAGE(kinds.table, kinds.messages);
  REQUIRE(kinds.table->kinds.size() == 2);
  CHECK(kinds.table->kinds[0].name == "b");
  CHECK(kinds.table->kinds[0].placements[1].position == glm::dvec3(7, 8, 9));
  CHECK(kinds.table->kinds[1].name == "a, #1");
}

TEST_CASE("tables: matrices of three decimals are repaired and counted") {
  const Reading reading = read(
      "x,y,z,m00,m01,m02,m10,m11,m12,m20,m21,m22\n"
      "1,2,3,0.272,-0.271,0.923,0.022,-0.957,-0.288,0.962,0.099,-0.255\n4,5,6,1,0,0,0,1,0,0,0,1\n");
  REQUIRE_MESSAGE(reading.table, reading.messages);
  CHECK(reading.table->repaired == 1);
  CHECK(reading.table->worst < 2e-3);
  const glm::dmat3 r = reading.table->kinds[0].placements[0].rotation;
  CHECK(distance(glm::transpose(r) * r, glm::dmat3(1)) < 1e-14);
  CHECK(std::abs(r[0][2] - 0.962) < 1e-3);
}

TEST_CASE("tables: faults stand at their line and column, all of rows") {
  const Reading reading = read("x,y,z,scale\n1,2,3\n1,oo,3,1\n1,2,3,0\n1,2,,1\n1,2,3,-1\n");
  CHECK_FALSE(reading.table);
  for (const char* const part :
       {"t:2:1: error[E0564]: the row has 3 fields, the first one 4", "t:3:3: error[E0564]: 'y' is 'oo', not a finite",
        "t:4:7: error[E0564]: 'scale' is '0', it must be greater", "t:5:1: error[E0564]: 'z' is ''",
        "t:6:7: error[E0564]: 'scale' is '-1'"})
    CHECK_MESSAGE(reading.messages.find(part) != std::string::npos, reading.messages);
  check_refused("x,y,z,qw,qx,qy,qz\n1,2,3,1,0,0,0\n1,2,3,2,0,0,0\n", "t:3:7: error[E0567]");
  check_refused("m00 m01 m02 m10 m11 m12 m20 m21 m22 x y z\n-1 0 0 0 1 0 0 0 1 1 2 3\n", "t:2:1: error[E0567]");
  check_refused("x,y\n1,2\n", "t:1:1: error[E0565]: the table has a column 'y' but none named 'z'");
  check_refused("a,b\n1,2\n", "t:1:1: error[E0565]: the table has no columns x, y and z");
  check_refused("x,y,z,x\n1,2,3,4\n", "t:1:7: error[E0565]: the column 'x' stands twice");
  check_refused("x,y,z,scale,sx,sy,sz\n", "t:1:1: error[E0565]: the table has both");
  check_refused("x,y,z,rx,ry,rz,qx,qy,qz,qw\n", "t:1:1: error[E0565]: the table has rotations of two forms");
  check_refused("1 2 3 4 5\n", "t:1:1: error[E0565]: 5 fields without names");
  check_refused("1 2 3 4 5\n", "t:1:1: error[E0565]: the row has 5 fields, --columns names 3", "x,y,z");
  check_refused("x,y,z\n# none\n", "t:1:1: error[E0566]");
  check_refused("", "t: error[E0566]");
  check_refused("x,y,z,kind\n1,2,3,\"a\n", "t:2:7: error[E0564]: a quote");
}

namespace {

/// The names of the kinds, in order, between bars.
std::string kinds_of(const Reading& reading) {
  REQUIRE_MESSAGE(reading.table, reading.messages);
  std::string names = "|";
  for (const PlacedKind& kind : reading.table->kinds) names += kind.name + '|';
  return names;
}

}  // namespace

TEST_CASE("tables: quotes as RFC 4180 has them, in every separation, with any line ends and a mark") {
  CHECK(kinds_of(read("x,y,z,kind\n1,2,3,\"a \"\"big\"\" one\"\n4,5,6,b\n")) == "|a \"big\" one|b|");
  CHECK(kinds_of(read("1,2,3,\"a\nb\"\n4,5,6,\"\"\"\"\n7,8,9,\"x,#y\" # z\n")) == "|a\nb|\"|x,#y|");
  CHECK(kinds_of(read("1\t2\t3\t\"a\tb\"\n")) == "|a\tb|");
  CHECK(kinds_of(read("1;2;3;\"a;b\"\n")) == "|a;b|");
  CHECK(kinds_of(read("1 2 3 \"a b\"\n4 5 6 c \n")) == "|a b|c|");
  CHECK(kinds_of(read("1,2,3,5\" pipe # of steel\n")) ==
        "|5\" pipe|");  // only a field that begins with a quote has quotes
  CHECK(kinds_of(read("\"kind\" ,\"x\",\"y\",\"z\"\n\"a\",\"1\", \"2\" ,\"3\"\n")) == "|a|");
  // The separator is not one that stands within quotes.
  CHECK(kinds_of(read("\"a,b\";x;y;z;kind\n1;2;3;4;c\n")) == "|c|");
  for (const char* const end : {"\n", "\r\n", "\r"}) {
    std::string text = "\xef\xbb\xbfx,y,z,kind";
    for (const char* const line : {"1,2,3,a", "", ",,,", "4,5,6,\"b\"", "7,8,9,"}) text += end + std::string(line);
    CHECK(kinds_of(read(text)) == "|a|b||");
  }
}

TEST_CASE("tables: faults of quotes and numbers at their place, behind quoted line ends too") {
  check_refused("x,y,z,kind\n1,2,3,\"a\" b\n", "t:2:11: error[E0564]: text behind a closing quote");
  check_refused("x,y,z,kind\n1,2,3,\"a\"\"\n4,5,6,b\n", "t:2:7: error[E0564]: a quote that is not closed");
  check_refused("\"", "t:1:1: error[E0564]: a quote");
  check_refused("x,y,z,kind\n1,2,3,\"a\nb\"\n4,o,6,c\n", "t:4:3: error[E0564]: 'y' is 'o'");
  check_refused("x;y;z\n1;2,5;3\n", "t:2:3: error[E0564]: 'y' is '2,5', not a finite number; write 2.5, with a point");
  check_refused("\xff\xfex", "t: error[E0564]: the file is UTF-16");
}

TEST_CASE("names of files: plain characters, told apart in any case, none the end of another's") {
  const std::vector<std::string> names{"A b", "a_B", "all", "../x", "", "a", "a_scale", "\xc3\xa4"};
  const std::vector<std::string> files = file_names_of(names);
  CHECK(files == std::vector<std::string>{"A_b", "a_B_2", "all_2", ".._x", "kind", "a", "a_scale_2", "kind_2"});
}

TEST_CASE("colours of kinds differ") {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < 600; ++i) CHECK(seen.insert(kind_rgb(i)).second);
}

TEST_CASE("a scene gives every placement back, inside the cube") {
  std::vector<Placement> placements;
  for (const glm::dmat3& r : rotations()) {
    const double i = static_cast<double>(placements.size());
    placements.push_back({{100 + 3 * i, -7 * std::sin(i), i}, r, {1, 2 + 0.1 * i, 0.5}});
  }
  const MoleculeFrame frame = fit_placements(placements);
  const PlacementFiles files = placement_files(placements, frame);
  const std::vector<PlacedObject> objects{{"K", placements.size(), simple_object("K", kind_rgb(0), true)}};
  const std::map<std::string, std::string> texts{{"s.voml", placed_scene(objects, "s", "a--b<c")},
                                                 {"s_K.txt", files.seeds},
                                                 {"s_K_rotate.txt", files.rotates},
                                                 {"s_K_scale.txt", files.scales}};
  Diagnostics diagnostics(true);
  const auto scene = voml::read_scene("s.voml", memory_files(texts), {}, diagnostics);
  REQUIRE_MESSAGE(scene, diagnostics.render());
  CHECK_MESSAGE(diagnostics.all().empty(), diagnostics.render());
  REQUIRE(scene->seed_lists.size() == 1);
  const auto& seeds = scene->seed_lists[0].seeds;
  REQUIRE(seeds.size() == placements.size());
  double farthest = 0;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const double unit = frame.angstrom_per_unit;
    const glm::dvec3 at = 2.0 * seeds[i].position;  // spec/voml.md, Seeds
    CHECK(glm::distance(at * unit + frame.center, placements[i].position) < 1e-6);
    CHECK(distance(composed(seeds[i].rotate_deg), placements[i].rotation) < 3e-9);
    CHECK(glm::distance(seeds[i].scale * unit, placements[i].scale) < 1e-6);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 local(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const glm::dvec3 p = glm::abs(at + composed(seeds[i].rotate_deg) * (seeds[i].scale * local));
      farthest = std::max({farthest, p.x, p.y, p.z});
    }
  }
  CHECK(farthest == doctest::Approx(0.95));
}

namespace {

Molecule read_assemblies(std::string_view text) {
  Diagnostics diagnostics;
  MoleculeOptions options;
  options.assemblies = true;
  auto molecule = parse_molecule("m", text, options, diagnostics);
  REQUIRE_MESSAGE(molecule, diagnostics.render());
  return *molecule;
}

void check_assemblies_refused(std::string_view text, std::string_view place_and_code) {
  Diagnostics diagnostics;
  MoleculeOptions options;
  options.assemblies = true;
  CHECK_FALSE(parse_molecule("m", text, options, diagnostics));
  CHECK_MESSAGE(diagnostics.render().starts_with(place_and_code), diagnostics.render());
}

const std::string atoms_of_pdb =
    "ATOM      1  C   GLY A   1      10.000   0.000   0.000  1.00 20.00           C  \n"
    "ATOM      2  O   GLY B   1      12.000   1.000   3.000  1.00 20.00           O  \n";

// The second operator turns x to y and moves by (1, 2, 3).
const std::string quarter_of_pdb =
    "REMARK 350 BIOMOLECULE: 1\n"
    "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A,\n"
    "REMARK 350                    AND CHAINS: B\n"
    "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n"
    "REMARK 350   BIOMT1   2  0.000000 -1.000000  0.000000        1.00000\n"
    "REMARK 350   BIOMT2   2  1.000000  0.000000  0.000000        2.00000\n"
    "REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        3.00000\n"
    "REMARK 350 BIOMOLECULE: 2\n"
    "REMARK 350 APPLY THE FOLLOWING TO CHAINS: B\n"
    "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        5.00000\n"
    "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n";

std::string operators_of_cif(std::string_view expression) {
  std::string text =
      "data_M\nloop_\n_atom_site.type_symbol\n_atom_site.label_asym_id\n_atom_site.Cartn_x\n"
      "_atom_site.Cartn_y\n_atom_site.Cartn_z\nC A 1 0 0\nO B 0 2 0\nloop_\n_pdbx_struct_oper_list.id\n";
  for (int row = 1; row <= 3; ++row) {
    for (int column = 1; column <= 3; ++column)
      text += fmt::format("_pdbx_struct_oper_list.matrix[{}][{}]\n", row, column);
    text += fmt::format("_pdbx_struct_oper_list.vector[{}]\n", row);
  }
  text +=
      "1 1 0 0 0 0 1 0 0 0 0 1 0\n2 1 0 0 10 0 1 0 0 0 0 1 0\n3 1 0 0 20 0 1 0 0 0 0 1 0\n"
      "P 0 -1 0 0 1 0 0 0 0 0 1 0\n";
  return text + "_pdbx_struct_assembly_gen.assembly_id cell\n_pdbx_struct_assembly_gen.asym_id_list A,B\n" +
         fmt::format("_pdbx_struct_assembly_gen.oper_expression '{}'\n", expression);
}

/// The x and y to which the operators bring the origin moved by 1 along x.
std::vector<std::pair<double, double>> images(std::string_view expression) {
  const Molecule molecule = read_assemblies(operators_of_cif(expression));
  REQUIRE(molecule.assemblies.size() == 1);
  CHECK(molecule.assemblies[0].id == "cell");
  std::vector<std::pair<double, double>> result;
  for (const Operator& op : molecule.assemblies[0].parts.at(0).operators) {
    const glm::dvec3 p = op.rotation * glm::dvec3(1, 0, 0) + op.translation;
    result.emplace_back(p.x, p.y);
  }
  return result;
}

}  // namespace

TEST_CASE("assemblies of PDB: operators and chains, each atom where its operator brings it") {
  const Molecule molecule = read_assemblies(quarter_of_pdb + atoms_of_pdb);
  REQUIRE(molecule.assemblies.size() == 2);
  CHECK(molecule.assemblies[0].id == "1");
  CHECK(molecule.assemblies[0].parts.at(0).chains == std::vector<std::string>{"A", "B"});
  CHECK(molecule.assemblies[1].parts.at(0).chains == std::vector<std::string>{"B"});
  CHECK(molecule.repaired_operators == 0);

  const PlacedAssembly placed = place_assembly(molecule, molecule.assemblies[0]);
  REQUIRE(placed.units.size() == 1);
  const PlacedUnit& unit = placed.units[0];
  REQUIRE(unit.placements.size() == 2);
  const glm::dvec3 expected[2][2] = {{{10, 0, 0}, {12, 1, 3}}, {{1, 12, 3}, {0, 14, 6}}};  // (-y + 1, x + 2, z + 3)
  for (int op = 0; op < 2; ++op) {
    for (int i = 0; i < 2; ++i) {
      const Atom& atom = unit.atoms[static_cast<std::size_t>(i)];
      const Placement& p = unit.placements[static_cast<std::size_t>(op)];
      const glm::dvec3 local = (atom.position - unit.frame.center) / unit.frame.angstrom_per_unit;
      const glm::dvec3 world = p.position + p.rotation * (p.scale * local);
      CHECK(glm::distance(world, expected[op][i]) < 1e-12);
      for (int axis = 0; axis < 3; ++axis)
        CHECK(std::abs(world[axis] - placed.frame.center[axis]) + atom.element->radius <=
              0.95 * placed.frame.angstrom_per_unit + 1e-9);
    }
  }
  CHECK(place_assembly(molecule, molecule.assemblies[1]).units.at(0).atoms.size() == 1);
}

TEST_CASE("assemblies of PDB: faults at line and column") {
  std::string number = quarter_of_pdb, order = quarter_of_pdb, mirror = quarter_of_pdb;
  number.replace(number.find("1.00000\n", number.find("BIOMT1   2")), 7, "1.0000x");
  check_assemblies_refused(number + atoms_of_pdb, "m:7:62: error[E0563]");
  order.replace(order.find("BIOMT2   1"), 6, "BIOMT3");
  check_assemblies_refused(order + atoms_of_pdb, "m:5:19: error[E0563]: the row BIOMT2");
  mirror.replace(mirror.find(" 1.000000"), 9, "-1.000000");
  // Serial numbers of four digits shift the columns.
  std::string shifted = quarter_of_pdb;
  for (std::size_t at; (at = shifted.find("   2 ")) != std::string::npos;) shifted.replace(at, 5, "  1680 ");
  CHECK(read_assemblies(shifted + atoms_of_pdb).assemblies[0].parts[0].operators[1].translation == glm::dvec3(1, 2, 3));
  check_assemblies_refused(mirror + atoms_of_pdb, "m:4:25: error[E0567]");
}

TEST_CASE("assemblies of mmCIF: lists, ranges and products of operators") {
  using Points = std::vector<std::pair<double, double>>;
  CHECK(images("1") == Points{{1, 0}});
  CHECK(images("1,3") == Points{{1, 0}, {21, 0}});
  CHECK(images("(1-3)") == Points{{1, 0}, {11, 0}, {21, 0}});
  CHECK(images("P,1-2") == Points{{0, 1}, {1, 0}, {11, 0}});
  // The right one acts first: move by 10, then turn x to y.
  CHECK(images("(P)(2)") == Points{{0, 11}});
  CHECK(images("(2,3)(P,1)") == Points{{10, 1}, {11, 0}, {20, 1}, {21, 0}});
}

TEST_CASE("assemblies of mmCIF: faults in expressions") {
  // The value begins in column 44 of line 30, behind its quote.
  check_assemblies_refused(operators_of_cif("1,4"), "m:30:46: error[E0563]: there is no operator '4'");
  check_assemblies_refused(operators_of_cif("1-4"), "m:30:44: error[E0563]: there is no operator '4'");
  check_assemblies_refused(operators_of_cif("3-1"), "m:30:44: error[E0563]: '3-1' is no range");
  check_assemblies_refused(operators_of_cif("(1)(2"), "m:30:47: error[E0563]: a bracket");
  check_assemblies_refused(operators_of_cif("1(2)"), "m:30:44: error[E0563]: an expression");
  check_assemblies_refused(operators_of_cif(""), "m:30:44: error[E0563]: the operators of an assembly are not given");
}

namespace {

struct PackingReading {
  std::optional<Packing> packing;
  std::string messages;
};

PackingReading read_packing(std::string_view text, double radius = 0.0) {
  Diagnostics diagnostics;
  PackingReading result;
  result.packing = parse_cellpack(
      "c", text, [&](const std::string&) { return radius; }, diagnostics);
  result.messages = diagnostics.render();
  return result;
}

void check_packing_refused(std::string_view text, std::string_view place_and_code) {
  const PackingReading reading = read_packing(text);
  CHECK_FALSE(reading.packing);
  CHECK_MESSAGE(reading.messages.starts_with(place_and_code), reading.messages);
}

const Ingredient& only_ingredient(const PackingReading& reading) {
  REQUIRE_MESSAGE(reading.packing, reading.messages);
  REQUIRE(reading.packing->ingredients.size() == 1);
  return reading.packing->ingredients[0];
}

/// An ingredient that stands at the origin, unturned.
std::string placed_once(std::string_view members) {
  return fmt::format(R"({{"A": {{"results": [[[0,0,0],[1,0,0,0]]]{}}}}})", members);
}

}  // namespace

TEST_CASE("cellPACK: beads and placements, wherever ingredients stand") {
  const std::string start =
      R"({"recipe":{"name":"n"},"compartments":{"in":{"interior":{"ingredients":{"A":{"results":)";
  const std::string end = R"(},"none":{"results":[]}}}}}})";
  const std::string turned = "[[[10,0,0],[0.7071067811865476,0,0,0.7071067811865476]]]";  // x -> y
  const auto reading = read_packing(start + turned + R"(,"positions":[[[1,0,0]]],"radii":[[2]])" + end);
  const Ingredient& ingredient = only_ingredient(reading);
  CHECK(ingredient.name == "A");
  CHECK(reading.packing->repaired == 0);
  CHECK(reading.packing->without_beads == 0);
  const MoleculeFrame frame = fit_packing(*reading.packing);  // one ball of radius 2 at (10, 1, 0)
  CHECK(glm::distance(frame.center, glm::dvec3(10, 1, 0)) < 1e-12);
  CHECK(frame.angstrom_per_unit == doctest::Approx(2 / 0.95));
  CHECK(fit_beads(ingredient).center == glm::dvec3(1, 0, 0));
  CHECK(bead_files(ingredient, {{0, 0, 0}, 4}).seeds == "0.125000000 0.000000000 0.000000000\n");  // 1 / 8
  // In a list, an ingredient is named by its name.
  CHECK(only_ingredient(read_packing(R"({"groups":[{"name":"B","results":[[[0,0,0],[1,0,0,0]]],"radius":1}]})")).name ==
        "B");
}

TEST_CASE("cellPACK: beads as lists of points, as Mesoscope writes them, and levels of detail") {
  const std::vector<glm::dvec3> two{{1, 2, 3}, {4, 5, 6}};
  for (
      const char* const members :
      {R"(,"positions": [[[1,2,3],[4,5,6]], [[9,9,9]]], "radii": [[7,8],[9]])",
       R"(,"positions": [{"coords": [1,2,3,4,5,6]}, {"coords": [9,9,9]}], "radii": [{"radii": [7,8]}, {"radii": [9]}])",
       R"(,"positions": {"coords": [1,2,3,4,5,6]}, "radii": {"radii": [7,8]})",
       R"(,"positions": [[1,2,3],[4,5,6]], "radii": [7,8])", R"(,"positions": [[1,2,3,4,5,6]], "radii": [[7,8]])"}) {
    const auto reading = read_packing(placed_once(members));
    const Ingredient& ingredient = only_ingredient(reading);
    REQUIRE(ingredient.beads.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(ingredient.beads[i].position == two[i]);
      CHECK(ingredient.beads[i].radius == 7.0 + static_cast<double>(i));
    }
  }
}

TEST_CASE("cellPACK: without beads an ingredient is a ball: of the recipe's radius, else of the given one") {
  // As cellPACK's own example of discs writes it.
  const auto discs = read_packing(
      R"({"recipe":{"name":"root"},"cytoplasme":{"ingredients":{"Ball":{"name":"Ball","Type":"SingleSphere","radius":25,)"
      R"("encapsulatingRadius":30,"results":[[[100,0,0],[1,0,0,0]],[[0,200,0],[1,0,0,0]]]}}}})");
  const Ingredient& ball = only_ingredient(discs);
  CHECK(ball.placements.size() == 2);
  REQUIRE(ball.beads.size() == 1);
  CHECK(ball.beads[0].position == glm::dvec3(0));
  CHECK(ball.beads[0].radius == 25);
  CHECK(discs.packing->without_beads == 1);
  const auto radius_of = [](std::string_view members) {
    const auto reading = read_packing(placed_once(members), 5.0);
    return only_ingredient(reading).beads.at(0).radius;
  };
  CHECK(radius_of(R"(,"encapsulatingRadius": 30)") == 30);
  CHECK(radius_of(R"(,"positions": [], "radii": [], "encapsulatingRadius": 30)") == 30);
  CHECK(radius_of(R"(,"radii": [[25]])") == 25);  // a ball's own
  CHECK(radius_of(R"(,"positions": null, "radius": 0)") == 5);
  CHECK(radius_of("") == 5);
  CHECK(radius_of(R"(,"positions": [[[1,2,3]]])") == 5);
  CHECK(radius_of(R"(,"positions": [[[1,2,3]]],"radius": 30)") == 30);
  CHECK(radius_of(R"(,"positions": [[[1,2,3],[4,5,6]]],"radius": 30)") == 5);  // that of all of it
  check_packing_refused(placed_once(""),
                        "c:1:7: error[E0568]: 'A' has no radii of beads, and neither 'radius' nor "
                        "'encapsulatingRadius'; give it a radius by --radius");
  check_packing_refused(placed_once(R"(,"positions": [[[1,2,3],[4,5,6]]])"),
                        "c:1:7: error[E0568]: 'A' has beads without");
  check_packing_refused(placed_once(R"(,"radius": -1)"), "c:1:51: error[E0568]: a radius must be greater than zero");
}

TEST_CASE("cellPACK: the same packing with matrices and with quaternions, as it was published") {
  // NM_Analysis_FigureC1.4 of cellPACK_data, .apr.json and .cpr.json: w x y z, and rows.
  const auto matrices = read_packing(R"({"A":{"encapsulatingRadius":75,"results":[
    [[290.63699,150.60117,0],[[-0.32365694,0.9461745,0,0],[-0.9461745,-0.32365694,0,0],[0,0,1,0],[0,0,0,1]]],
    [[723.35352,257.21872,0],[[0.44196128,-0.89703413,0],[0.89703413,0.44196128,0],[0,0,1]]]]}})");
  const auto quaternions = read_packing(R"({"A":{"encapsulatingRadius":75,"results":[
    [[290.63699,150.60117,0],[0.58152518,0,0,-0.81352841]],[[723.35352,257.21872,0],[0.84910579,0,0,0.52822283]]]}})");
  for (std::size_t i = 0; i < 2; ++i) {
    const Placement &a = only_ingredient(matrices).placements.at(i), &b = only_ingredient(quaternions).placements.at(i);
    CHECK(a.position == b.position);
    CHECK(distance(a.rotation, b.rotation) < 1e-7);
  }
  CHECK(quaternions.packing->real_last == 0);
  const auto at = [](std::string_view position, std::string_view column) {  // a matrix that moves as well
    const std::string text = fmt::format(
        R"({{"A":{{"radius":1,"results":[[{},[[1,0,0,{}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]]]}}}})", position, column);
    const auto reading = read_packing(text);
    return reading.packing ? only_ingredient(reading).placements.at(0).position.x : -1.0;
  };
  CHECK(at("[0,0,0]", "4") == 4);
  CHECK(at("[4,0,0]", "0") == 4);
  CHECK(at("[4,0,0]", "4") == 4);
  CHECK(at("[4,0,0]", "3") == -1);  // refused
}

TEST_CASE("cellPACK: quaternions of ingredients with a principalAxis have their real part last") {
  // CD63 of exosomes.json and GAG of HIV_immature_model.json (cellPACK_data): the axis of a membrane's protein points
  // outward.
  const auto exosome = read_packing(R"({"CD63":{"radius":20,"principalAxis":[0,0,1],"results":[
    [[272.2845,387.9836,143.3515],[-0.02428811,0.5952667,0.6366376,0.4896528]],
    [[-197.4492,-49.74862,450.7381],[-0.1843677,-0.1004093,0.9464042,0.245449]],
    [[592.8232,42.71677,65.38968],[0.2089952,-0.6344509,0.1799973,-0.7220761]]]}})");
  for (const Placement& placement : only_ingredient(exosome).placements)
    CHECK(glm::dot(placement.rotation * glm::dvec3(0, 0, 1), glm::normalize(placement.position)) > 0.99);
  CHECK(exosome.packing->real_last == 3);
}

TEST_CASE("cellPACK: faults stand at the value that is at fault") {
  check_packing_refused("{\n\"a\": x}", "c:2:6: error[E0568]: the text is not JSON here");
  check_packing_refused("\xef\xbb\xbf{\n\"a\": x}", "c:2:6: error[E0568]");
  check_packing_refused("{\"a\": 1", "c:1:7: error[E0568]");
  check_packing_refused("{}", "c:1:1: error[E0568]: no ingredient");
  check_packing_refused("{\n \"b\": [2, 1e400]}", "c:2:11: error[E0568]: a number is larger than any double");
  check_packing_refused(placed_once(R"(,"radius": 1e39)"), "c:1:51: error[E0568]: a number is beyond the range");
  std::string deep = "1";
  for (int i = 0; i < 1000; ++i) deep = "{\"a\":" + deep + "}";
  check_packing_refused(deep, "c:1:326: error[E0568]: objects stand more than 64 deep");  // behind 65 times {"a":
  const auto in_results = [](std::string_view entry) {
    return fmt::format(
        "{{\"x\": [1, \"]\\\"[\", {{}}],\n \"A\": {{\"radius\": 1,\n  \"results\": [[[0,0,0],[1,0,0,0]],\n{}]}}}}",
        entry);
  };
  check_packing_refused(in_results("[[1,0,0],[2,0,0,0]]"), "c:4:10: error[E0567]: this rotation of 'A'");
  check_packing_refused(in_results("[[1,0,0],[1,0,0]]"), "c:4:10: error[E0568]: a quaternion has 4 numbers");
  check_packing_refused(in_results("[[1,0,\"0\"],[1,0,0,0]]"), "c:4:7: error[E0568]: this is not a number");
  check_packing_refused(in_results("[[1,0],[1,0,0,0]]"), "c:4:2: error[E0568]: this is not a list of 3 numbers");
  check_packing_refused(in_results("[[1,0,0],[1,0,0,0],3]"),
                        "c:4:1: error[E0568]: a placement is [position, rotation]");
  check_packing_refused(in_results("[[1,0,0],[[1,0,0],[0,1,0]]]"), "c:4:10: error[E0568]: a rotation has 3 or 4 rows");
  check_packing_refused(in_results("[[1,0,0],[[1,0],[0,1],[0,0]]]"), "c:4:11: error[E0568]: a row of a rotation");
  check_packing_refused(in_results("[[1,0,0],[[-1,0,0],[0,1,0],[0,0,1]]]"), "c:4:10: error[E0567]");
  check_packing_refused(in_results("[[0,0,0],[[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,0,0,1]]]"),
                        "c:4:41: error[E0568]: the fourth row is not 0 0 0 1");
  check_packing_refused(R"({"A": {"results": "other.bin"}})", "c:1:19: error[E0568]: 'results' is not a list");
  check_packing_refused(placed_once(R"(,"positions": [[[1,2,3]]], "radii": [[2,3]])"),
                        "c:1:77: error[E0568]: 'A' has 1 beads and 2 radii");
  check_packing_refused(placed_once(R"(,"positions": [{"coords": [1,2]}])"),
                        "c:1:66: error[E0568]: 2 numbers are no points");
  check_packing_refused(placed_once(R"(,"positions": [{"points": []}])"),
                        "c:1:55: error[E0568]: a level of detail without");
  check_packing_refused(R"({"snake": {"nbCurve": 1, "results": []}})",
                        "c:1:1: error[E0568]: no ingredient with 'results'; curves");
}

#ifdef DMVV_HIV
TEST_CASE("cellPACK: a mature HIV-1 particle, as many of each as its description says") {
  Diagnostics diagnostics;
  const auto packing = parse_cellpack("hiv", disk_files()(DMVV_HIV, 1u << 24).value(), {}, diagnostics);
  REQUIRE_MESSAGE(packing, diagnostics.render());
  std::size_t placements = 0, beads = 0;
  for (const Ingredient& ingredient : packing->ingredients) {
    placements += ingredient.placements.size();
    beads += ingredient.beads.size();
  }
  CHECK(packing->ingredients.size() == 26);
  CHECK(placements == 11681);
  CHECK(beads == 384);
}
#endif
