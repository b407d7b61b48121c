#include "tests/unit/mesh/mesh_test.h"

namespace dmvv::tests {

namespace {

const std::string text_tetrahedron =
    "solid a tetrahedron\n"
    " facet normal 0 0 -1\n  outer loop\n   vertex 0 0 0\n   vertex 0 1 0\n   vertex 1 0 0\n  endloop\n endfacet\n"
    " facet normal 0 -1 0\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 0 1\n  endloop\n endfacet\n"
    " facet normal -1 0 0\n  outer loop\n   vertex -0 0 0\n   vertex 0 0 1\n   vertex 0 1 0\n  endloop\n endfacet\n"
    " FACET NORMAL nan nan nan\n  OUTER LOOP\n   VERTEX 1 0 0\n   vertex 0 1 0\n   vertex 0 0 1\n  endloop\n endfacet\n"
    "endsolid a tetrahedron\n";

const Positions positions_of_tetrahedron{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
const Triangles triangles_of_tetrahedron{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {2, 1, 3}};

std::string binary_tetrahedron(std::string_view title, char filling = '\0') {
  std::string bytes(title);
  bytes.resize(80, filling);
  put(bytes, std::uint32_t{4});
  for (const glm::uvec3& triangle : triangles_of_tetrahedron) {
    for (int axis = 0; axis < 3; ++axis) put(bytes, NAN);  // normals are not read
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) {
        put(bytes, static_cast<float>(positions_of_tetrahedron[triangle[corner]][axis]));
      }
    }
    put(bytes, std::uint16_t{0xffff});
  }
  return bytes;
}

}  // namespace

TEST_CASE("STL: text and binary give the same mesh with merged corners") {
  const std::string files[] = {text_tetrahedron, binary_tetrahedron("made by hand"),
                               binary_tetrahedron("solid as many exporters write"),
                               binary_tetrahedron("solid padded with blanks", ' ')};
  for (const std::string& bytes : files) {
    for (const char* path : {"a.stl", "without an ending"}) {
      const voml::Mesh mesh = mesh_of(path, bytes);
      CHECK(mesh.positions == positions_of_tetrahedron);
      CHECK(mesh.triangles == triangles_of_tetrahedron);
      CHECK(voml::find_edge_faults(mesh).count() == 0);
    }
  }
}

TEST_CASE("STL: several solids in one text, with CR LF") {
  std::string text;
  for (const char c : text_tetrahedron + text_tetrahedron) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  CHECK(mesh_of("a.stl", text).triangles.size() == 8);
}

TEST_CASE("STL: faults of a text are named with line and column") {
  const std::string start = "solid x\nfacet normal 0 0 1\nouter loop\n";
  check_refused_at("a.stl", "solid x\nfacets\n", Code::mesh_syntax, 2, 1);
  check_refused_at("a.stl", "solid x\nfacet normal 0 0 1\ninner loop\n", Code::mesh_syntax, 3, 1);
  check_refused_at("a.stl", start + "vertex 0 0 zero\n", Code::mesh_syntax, 4, 12);
  check_refused_at("a.stl", start + "vertex 0 0\n", Code::mesh_syntax, 4, 11);
  check_refused_at("a.stl", start + "vertex 0 inf 0\n", Code::mesh_number_not_finite, 4, 10);
  check_refused_at("a.stl", start + "vertex 0 0 0\nvertex 0 0 0\nendloop\n", Code::mesh_syntax, 6, 1);
  check_refused_at("a.stl", start + "vertex 0 0 0\nvertex 0 0", Code::mesh_truncated, 5, 11);
  check_refused_at("a.stl", "solid x\n", Code::mesh_truncated, 2, 1);
  CHECK(refusal_of(parse("a.stl", "solid x\nendsolid x\n")).code == Code::mesh_without_triangles);
}

TEST_CASE("STL: faults of binary data are named with their byte") {
  const std::string good = binary_tetrahedron("made by hand");
  check_refused_at_byte("a.stl", "short", Code::mesh_truncated, 5);
  check_refused_at_byte("a.stl", good.substr(0, 80) + std::string(4, '\0') + good.substr(84), Code::mesh_syntax, 80);
  std::string lying = good;
  lying[83] = '\x7f';
  check_refused_at_byte("a.stl", lying, Code::mesh_truncated, 80);
  std::string infinite = good;
  const std::size_t offset = 84 + 2 * 50 + 12 + 12 + 4;  // y of the second corner of the third facet
  infinite.replace(offset, 4, std::string("\0\0\x80\x7f", 4));
  check_refused_at_byte("a.stl", infinite, Code::mesh_number_not_finite, offset);
  std::string none = good.substr(0, 84);
  none.replace(80, 4, std::string(4, '\0'));
  CHECK(refusal_of(parse("a.stl", none)).code == Code::mesh_without_triangles);
}

TEST_CASE("STL: a file cut off anywhere is refused") {
  // A text is complete once its last keyword is.
  const std::string text = text_tetrahedron.substr(0, text_tetrahedron.rfind("endsolid") + 8);
  for (const std::string& bytes : {text, binary_tetrahedron("made by hand"), binary_tetrahedron("solid rock")}) {
    CHECK(mesh_of("a.stl", bytes).triangles.size() == 4);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      CAPTURE(size);
      refusal_of(parse("a.stl", std::string_view(bytes).substr(0, size)));
    }
  }
}

TEST_CASE("a mesh of no known format is refused") {
  for (const char* path : {"a.of", "obj", "a.ob", ""}) {
    const Diagnostic refusal = refusal_of(parse(path, "OFFS\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
    CHECK(refusal.code == Code::mesh_unknown_format);
  }
}

}  // namespace dmvv::tests
