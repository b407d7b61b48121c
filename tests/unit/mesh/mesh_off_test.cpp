#include "tests/unit/mesh/mesh_test.h"

namespace dmvv::tests {

namespace {

const Positions tetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const Triangles faces_of_tetrahedron{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

}  // namespace

TEST_CASE("OFF: every form of the same tetrahedron") {
  const std::string faces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const std::string files[] = {
      "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + faces,
      "# made by hand\n\nOFF # a tetrahedron\n# counts\n4 4 0\r\n\r\n0 0 0 # first\n1 0 0\n0 1 0\n\n0 0 1\n" + faces +
          "\n# end\n",
      "OFF 4 4 6 0 0 0 1 0 0 0 1 0 0 0 1 " + faces,  // lines don't matter
      "COFF\n4 4 6\n0 0 0 255 0 0 255\n1 0 0 1 1 1\n0 1 0 0.5 0.5 0.5 1\n0 0 1 0 0 0 0\n" + faces,  // colours
      "STCNOFF\n4 4 6\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 1 0 0\n0 1 0 0 0 1 1 1 1 1 0 0\n0 0 1 0 0 1 1 1 1 1 "
      "0 0\n" +
          faces,
      "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1 255 0 0\n3 0 1 3 7\n3 0 3 2 0.1 0.2 0.3 1 # red\n3 1 2 3"};
  for (const std::string& bytes : files) {
    for (const char* path : {"a.off", "without an ending", "a.obj"}) {
      CAPTURE(bytes);
      const voml::Mesh mesh = mesh_of(path, bytes);
      CHECK(mesh.positions == tetrahedron);
      CHECK(mesh.triangles == faces_of_tetrahedron);
      CHECK(voml::find_edge_faults(mesh).count() == 0);
    }
  }
  CHECK(mesh_of("a.OFF", "4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + faces).triangles == faces_of_tetrahedron);
}

TEST_CASE("OFF: polygons are fanned; points and edges have no area") {
  const voml::Mesh mesh = mesh_of("a.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n1 0\n2 0 1\n4 0 1 2 3\n");
  CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 2, 3}});
}

TEST_CASE("OFF: faults are named with line and column") {
  const std::string start = "OFF\n3 1 3\n0 0 0\n1 0 0\n";
  check_refused_at("a.off", "4OFF\n3 1 3\n", Code::mesh_syntax, 1, 1);
  check_refused_at("a.off", "nOFF\n3 1 3\n", Code::mesh_syntax, 1, 1);
  check_refused_at("a.off", std::string("OFF BINARY\n\0\0\0\3", 15), Code::mesh_syntax, 1, 5);
  check_refused_at("a.off", "OBJ\n3 1 3\n", Code::mesh_syntax, 1, 1);
  check_refused_at("a.off", "OFF\n3 1\n", Code::mesh_truncated, 3, 1);
  check_refused_at("a.off", "OFF\n-3 1 3\n0 0 0\n", Code::mesh_syntax, 2, 1);
  check_refused_at("a.off", "OFF\n3 4294967296 3\n0 0 0\n", Code::mesh_syntax, 2, 3);
  check_refused_at("a.off", "OFF\n4294967295 1 3\n0 0 0\n", Code::mesh_truncated, 2, 15);
  check_refused_at("a.off", "OFF\n3 4294967295 3\n0 0 0\n", Code::mesh_truncated, 2, 15);
  check_refused_at("a.off", start + "0 one 0\n3 0 1 2\n", Code::mesh_syntax, 5, 3);
  check_refused_at("a.off", start + "0 nan 0\n3 0 1 2\n", Code::mesh_number_not_finite, 5, 3);
  check_refused_at("a.off", start + "0 1e999 0\n3 0 1 2\n", Code::mesh_number_not_finite, 5, 3);
  check_refused_at("a.off", start + "0 1 0\n3 0 1 3\n", Code::mesh_index_out_of_range, 6, 7);
  check_refused_at("a.off", start + "0 1 0\n3 0 -1 2\n", Code::mesh_index_out_of_range, 6, 5);
  check_refused_at("a.off", start + "0 1 0\n0 0 1 2\n", Code::mesh_syntax, 6, 1);
  check_refused_at("a.off", start + "0 1 0\n1000000 0 1 2\n", Code::mesh_truncated, 7, 1);
  check_refused_at("a.off", start + "0 1 0\n3 0 1 2 red\n", Code::mesh_syntax, 6, 9);
  check_refused_at("a.off", "COFF\n3 1 3\n0 0 0 1 1 x\n1 0 0\n0 1 0\n3 0 1 2\n", Code::mesh_syntax, 3, 11);
}

TEST_CASE("OFF: without a triangle there is no mesh") {
  const Parsed parsed = parse("a.off", "OFF\n2 1 0\n0 0 0\n1 0 0\n2 0 1\n");
  CHECK(info(refusal_of(parsed).code).name == "mesh_without_triangles");
}

}  // namespace dmvv::tests
