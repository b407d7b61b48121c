// Files as programs really write them: byte order marks, other line ends and encodings, what stands behind the data,
// triangle strips. Each gives the mesh that the plain file gives.
#include "tests/unit/mesh/mesh_test.h"

namespace dmvv::tests {

namespace {

constexpr std::string_view mark = "\xef\xbb\xbf";

const std::string obj = "# a tetrahedron\nv 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 3 2 4\n";
const std::string off = "OFF\n4 4 6\n0 0 0\n0 1 0\n1 0 0\n0 0 1\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 2 1 3\n";
const std::string ply_header =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
const std::string ply =
    "ply\nformat ascii 1.0\n" + ply_header + "0 0 0\n0 1 0\n1 0 0\n0 0 1\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 2 1 3\n";
const Positions positions{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
const Triangles triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {2, 1, 3}};

std::string stl_text() {
  std::string text = "solid\n";
  for (const glm::uvec3& t : triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (int corner = 0; corner < 3; ++corner) {
      const glm::dvec3 p = positions[t[corner]];
      text += "vertex " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

std::string stl_binary(std::string title = "made by hand", char filling = '\0') {
  title.resize(80, filling);
  put(title, std::uint32_t{4});
  for (const glm::uvec3& t : triangles) {
    for (int axis = 0; axis < 3; ++axis) put(title, 0.0f);
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) put(title, static_cast<float>(positions[t[corner]][axis]));
    }
    put(title, std::uint16_t{0});
  }
  return title;
}

std::string ply_binary(std::endian order, const std::string& line_end = "\n", std::string first_data = {}) {
  std::string bytes = "ply\nformat " +
                      std::string(order == std::endian::big ? "binary_big_endian" : "binary_little_endian") + " 1.0\n" +
                      ply_header;
  std::string with_ends;
  for (const char c : bytes) with_ends += c == '\n' ? line_end : std::string(1, c);
  with_ends += first_data;
  for (const glm::dvec3& p : positions) {
    for (int axis = 0; axis < 3; ++axis) put(with_ends, static_cast<float>(p[axis]), order);
  }
  for (const glm::uvec3& t : triangles) {
    put(with_ends, std::uint8_t{3});
    for (int corner = 0; corner < 3; ++corner) put(with_ends, static_cast<std::int32_t>(t[corner]), order);
  }
  return with_ends;
}

std::string utf16(std::string_view text, std::endian order) {
  std::string bytes = order == std::endian::little ? "\xff\xfe" : "\xfe\xff";
  for (const char c : text) put(bytes, static_cast<std::uint16_t>(c), order);
  return bytes;
}

std::string with_line_ends(std::string_view text, const std::string& end) {
  std::string result;
  for (const char c : text) result += c == '\n' ? end : std::string(1, c);
  return result;
}

void check_is_tetrahedron(const voml::Mesh& mesh) {
  CHECK(mesh.positions == positions);
  CHECK(mesh.triangles == triangles);
}

}  // namespace

TEST_CASE("a byte order mark before any format") {
  const std::pair<const char*, std::string> files[] = {{"a.obj", obj},
                                                       {"a.off", off},
                                                       {"a.ply", ply},
                                                       {"a.ply", ply_binary(std::endian::little)},
                                                       {"a.ply", ply_binary(std::endian::big)},
                                                       {"a.stl", stl_text()},
                                                       {"a.stl", stl_binary()},
                                                       {"a.stl", stl_binary("solid by name")}};
  for (const auto& one : files) {
    const auto& path = one.first;
    const auto& bytes = one.second;
    CAPTURE(path);
    check_is_tetrahedron(mesh_of(path, bytes));
    check_is_tetrahedron(mesh_of(path, std::string(mark) + bytes));
  }
  for (const std::string& bytes : {off, ply, stl_text(), stl_binary()}) {  // known by their content
    check_is_tetrahedron(mesh_of("without an ending", std::string(mark) + bytes));
  }
  // The mark may as well be the beginning of a binary STL's title: its length tells.
  check_is_tetrahedron(mesh_of("a.stl", stl_binary(std::string(mark) + "title")));
  check_refused_at("a.obj", std::string(mark) + "v 0 0 zero\n", Code::mesh_syntax, 1, 7);  // no column is the mark's
}

TEST_CASE("a text that was redirected into UTF-16") {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::pair<const char*, std::string> files[] = {
        {"a.obj", obj}, {"a.off", off}, {"a.ply", ply}, {"a.stl", stl_text()}};
    for (const auto& [path, text] : files) check_is_tetrahedron(mesh_of(path, utf16(text, order)));
  }
  check_refused_at("a.obj", utf16("v 0 0 0\nv 0 0 zero\n", std::endian::little), Code::mesh_syntax, 2, 7);
  check_refused_at("a.obj", utf16("v 0 0 0\nv 0", std::endian::little) + "x", Code::mesh_syntax, 2,
                   4);  // half a character
}

TEST_CASE("lines that end with CR LF, or with CR alone") {
  for (const char* end : {"\r\n", "\r"}) {
    check_is_tetrahedron(mesh_of("a.obj", with_line_ends(obj, end)));
    check_is_tetrahedron(mesh_of("a.off", with_line_ends(off, end)));
    check_is_tetrahedron(mesh_of("a.ply", with_line_ends(ply, end)));
    check_is_tetrahedron(mesh_of("a.stl", with_line_ends(stl_text(), end)));
    for (const std::endian order : {std::endian::little, std::endian::big}) {
      check_is_tetrahedron(mesh_of("a.ply", ply_binary(order, end)));
    }
  }
}

TEST_CASE("PLY: behind a header whose lines end with CR, a line feed is the first byte of the data") {
  // A property whose first value is 10, the code of LF.
  std::string bytes = ply_binary(std::endian::little, "\r", "\n");
  bytes.insert(bytes.find("element vertex"), "element count 1\rproperty uchar n\r");
  check_is_tetrahedron(mesh_of("a.ply", bytes));
}

TEST_CASE("what stands behind the data is passed over, with a warning") {
  const Code code = Code::mesh_trailing_data;
  check_is_tetrahedron(mesh_with_warning(
      "a.stl", stl_binary() + std::string(16, '\0'), code,
      "the STL file promises 4 triangles; the 16 bytes behind the last one are passed over (at byte 284)"));
  check_is_tetrahedron(mesh_with_warning(
      "a.stl", stl_binary("solid by name", ' ') + std::string(100, 'x'), code,
      "the STL file promises 4 triangles; the 100 bytes behind the last one are passed over (at byte 284)"));
  check_is_tetrahedron(
      mesh_with_warning("a.stl", stl_text() + "\n\x1a", code, "1 bytes behind the last solid are passed over"));
  check_is_tetrahedron(
      mesh_with_warning("a.off", off + "3 0 1 2\n", code, "text behind the last of 4 faces is passed over"));
  check_is_tetrahedron(mesh_with_warning("a.ply", ply + "3 0 1 2\n", code,
                                         "data behind the last element that the header declares are passed over"));
  const std::string binary = ply_binary(std::endian::big);
  check_is_tetrahedron(
      mesh_with_warning("a.ply", binary + "\n", code,
                        "1 bytes behind the last element that the header declares are passed over (at byte " +
                            std::to_string(binary.size()) + ")"));
  check_is_tetrahedron(mesh_with_warning("a.obj", obj + std::string("\x1a\0\0", 3), code,
                                         "the text ends here; 3 bytes are passed over"));
  // A solid whose keyword is misspelt is no such thing: its triangles would be lost.
  std::string second = stl_text();
  second.replace(0, 5, "sol1d");
  check_refused_at("a.stl", stl_text() + second, Code::mesh_syntax, 31, 1);
}

TEST_CASE("PLY: triangle strips, with -1 between them, turn every second triangle around") {
  // A square of four corners as a strip, and a triangle of its own. Strip a b c d is (a b c), (c b d).
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n5 5 5\n";
  const auto strips = [&](const std::string& type, const std::string& list) {
    return "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
           "element tristrips 1\nproperty list int " +
           type + " vertex_indices\nend_header\n" + vertices + list + "\n";
  };
  const Triangles expected{{0, 1, 2}, {2, 1, 3}, {1, 2, 4}};
  CHECK(mesh_of("a.ply", strips("int", "8 0 1 2 3 -1 1 2 4")).triangles == expected);
  CHECK(mesh_of("a.ply", strips("int", "9 0 1 2 3 -1 1 2 4 -1")).triangles == expected);
  CHECK(mesh_of("a.ply", strips("uchar", "8 0 1 2 3 255 1 2 4")).triangles == expected);
  CHECK(mesh_of("a.ply", strips("uint", "8 0 1 2 3 4294967295 1 2 4")).triangles == expected);
  // Corners that are there twice join two strips, and count for the turns: 0 1 2 | 1 2 2, 2 2 3, 2 3 3 | 3 3 1, 3 1 4.
  CHECK(mesh_of("a.ply", strips("int", "8 0 1 2 2 3 3 1 4")).triangles == Triangles{{0, 1, 2}, {1, 3, 4}});
  // After -1 the turns begin anew: also behind an odd number of triangles.
  CHECK(mesh_of("a.ply", strips("int", "7 0 1 2 -1 1 2 4")).triangles == Triangles{{0, 1, 2}, {1, 2, 4}});
  check_refused_at("a.ply", strips("int", "4 0 1 2 5"), Code::mesh_index_out_of_range, 15, 9);
  check_refused_at("a.ply", strips("int", "3 0 1 -2"), Code::mesh_index_out_of_range, 15, 7);

  std::string binary = strips("int", "");
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  binary.resize(binary.find("end_header\n") + 11);
  for (const float c : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 1.f, 1.f, 0.f, 5.f, 5.f, 5.f}) put(binary, c);
  put(binary, std::int32_t{8});
  for (const std::int32_t corner : {0, 1, 2, 3, -1, 1, 2, 4}) put(binary, corner);
  CHECK(mesh_of("a.ply", binary).triangles == expected);
}

TEST_CASE("OFF: a count that adjoins the keyword, as in the ModelNet collection") {
  check_is_tetrahedron(mesh_of("a.off", "OFF4 4 6" + off.substr(9)));
  check_is_tetrahedron(mesh_of("without an ending", "OFF4 4 6" + off.substr(9)));
}

TEST_CASE("OBJ: continued lines, indices from the end, colours, what stands beside the mesh") {
  check_is_tetrahedron(
      mesh_of("a.obj",
              "mtllib a.mtl\no thing\nv 0 0 0 1 0 0\nv 0 1 \\\n0\nv 1 0 0 0.5 0.5 0.5\nv 0 0 1 # last\n"
              "vt 0 0\nvn 0 0 1\ng one two\ns off\nusemtl grey\n"
              "f 1//1 2//1 \\\r\n 3//1\nf -4 -2/1 -1/1/1\nf 1 4 2\nf 3 2 4\nl 1 2\np 1\n"));
}

TEST_CASE("a comma in a number: the message says how it is written") {
  const Parsed parsed = parse("a.obj", "v 0,5 0 0\n");
  CHECK(refusal_of(parsed).message ==
        "expected a coordinate, a number, found '0,5'; decimal numbers have a point: write 0.5");
}

}  // namespace dmvv::tests
