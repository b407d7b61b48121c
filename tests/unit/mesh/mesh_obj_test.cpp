#include <chrono>

#include <fmt/format.h>

#include "tests/unit/mesh/mesh_test.h"

namespace dmvv::tests {

TEST_CASE("OBJ: vertices and faces in all four forms of a corner") {
  const voml::Mesh mesh = mesh_of("a.obj",
                                  "# a comment\n"
                                  "mtllib a.mtl\n"
                                  "o thing\n"
                                  "v 0 0 0\n"
                                  "v 1 0 0 1.0\n"
                                  "  v\t+1.5e0 1 -0.25 0.1 0.2 0.3  # a colour behind it\n"
                                  "v 0 1 0\n"
                                  "vt 0 0\nvn 0 0 1\nusemtl x\ns off\n"
                                  "f 1 2 3\n"
                                  "f 1/1 2/1 3/1 # comment\n"
                                  "f 1//1 2//1 3//1\n"
                                  "f 1/1/1 2/1/1 3/1/1\n");
  CHECK(mesh.positions == Positions{{0, 0, 0}, {1, 0, 0}, {1.5, 1, -0.25}, {0, 1, 0}});
  CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}});
}

TEST_CASE("OBJ: polygons are fanned") {
  const voml::Mesh mesh = mesh_of("a.obj", "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n");
  CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
}

TEST_CASE("OBJ: negative indices count back from the latest vertex, positive ones may point ahead") {
  const voml::Mesh mesh = mesh_of("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2/7 -1//-9\nf 1 2 4\nv 0 0 1\nf -1 1 2\n");
  CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 1, 3}, {3, 0, 1}});
}

TEST_CASE("OBJ: lines are continued by a backslash, and end in LF, CR LF or the file's end") {
  const voml::Mesh mesh = mesh_of("A.OBJ", "v 0 \\\r\n 0 0\r\nv 1 0 0\r\nv 1 1 0\r\n# no \\\nf 9 9 9\nf 1\\\n2 \\\n3");
  CHECK(mesh.positions.size() == 3);
  CHECK(mesh.triangles == Triangles{{0, 1, 2}});
}

TEST_CASE("OBJ: every fault is named with its line and column") {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  check_refused_at("a.obj", "v 0 0 0\nv 1 zero 0\n", Code::mesh_syntax, 2, 5);
  check_refused_at("a.obj", "v 0 0 0\nv 1 0x2 0\n", Code::mesh_syntax, 2, 5);
  check_refused_at("a.obj", "v 0 0 0\nv 1 2\nf 1 2 3\n", Code::mesh_syntax, 2, 6);
  check_refused_at("a.obj", "v 0 0 0\nv 1 2", Code::mesh_truncated, 2, 6);
  check_refused_at("a.obj", "v 0 0 0\nv 1 2 3 red\n", Code::mesh_syntax, 2, 9);
  check_refused_at("a.obj", "v 0 0 nan\n", Code::mesh_number_not_finite, 1, 7);
  check_refused_at("a.obj", "v 0 -inf 0\n", Code::mesh_number_not_finite, 1, 5);
  check_refused_at("a.obj", "v 1e999 0 0\n", Code::mesh_number_not_finite, 1, 3);
  check_refused_at("a.obj", three + "f 1 2\n", Code::mesh_syntax, 4, 6);
  check_refused_at("a.obj", three + "f 1 2 4\n", Code::mesh_index_out_of_range, 4, 7);
  check_refused_at("a.obj", three + "f 1 2 4294967297\n", Code::mesh_index_out_of_range, 4, 7);
  check_refused_at("a.obj", three + "f 0 1 2\n", Code::mesh_index_out_of_range, 4, 3);
  check_refused_at("a.obj", three + "f 1 -4 2\n", Code::mesh_index_out_of_range, 4, 5);
  check_refused_at("a.obj", three + "f -1 -2 -3\nv 2 2 2\nf 1 2 5/1\n", Code::mesh_index_out_of_range, 6, 7);
  check_refused_at("a.obj", three + "f 1 2 3.5\n", Code::mesh_syntax, 4, 7);
  check_refused_at("a.obj", three + "f 1/2/3/4 2 3\n", Code::mesh_syntax, 4, 3);
  check_refused_at("a.obj", three + "f 1 2 99999999999999999999\n", Code::mesh_syntax, 4, 7);
  check_refused_at("a.obj", three + "\n\x01\x02\n", Code::mesh_syntax, 5, 1);
}

TEST_CASE("OBJ: an index beyond the end names both numbers") {
  const Diagnostic refusal = refusal_of(parse("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 30\n"));
  CHECK(refusal.message.find("30") != std::string::npos);
  CHECK(refusal.message.find("2") != std::string::npos);
}

TEST_CASE("OBJ: a file without a face has no triangle") {
  CHECK(refusal_of(parse("a.obj", "v 0 0 0\n")).code == Code::mesh_without_triangles);
  CHECK(refusal_of(parse("a.obj", "")).code == Code::mesh_without_triangles);
}

TEST_CASE("OBJ: a large file is read completely and fast") {
  constexpr int rows = 200;
  std::string text;
  for (int y = 0; y <= rows; ++y) {
    for (int x = 0; x <= rows; ++x) text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", x / 7.0, y / 7.0, x * y / 49.0);
  }
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < rows; ++x) {
      const int v = y * (rows + 1) + x + 1;
      text += fmt::format("f {} {} {} {}\n", v, v + 1, v + rows + 2, v + rows + 1);
    }
  }
  const auto start = std::chrono::steady_clock::now();
  const voml::Mesh mesh = mesh_of("a.obj", text);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  MESSAGE(mesh.triangles.size(), " triangles in ", 1e3 * taken.count(), " ms");
  CHECK(taken.count() < 1.0);  // a hundred times what it takes
  CHECK(mesh.positions.size() == (rows + 1) * (rows + 1));
  CHECK(mesh.triangles.size() == 2 * rows * rows);
  CHECK(mesh.positions.back() == glm::dvec3(28.571429, 28.571429, 816.326531));
}

}  // namespace dmvv::tests
