#include "tests/unit/mesh/mesh_test.h"

namespace dmvv::tests {

namespace {

const std::string header_of_quad =
    "comment made by hand\n"
    "obj_info nothing\n"
    "element camera 2\n"
    "property uchar flags\n"
    "property list uchar double matrix\n"
    "element vertex 4\n"
    "property float x\n"
    "property uint8 red\n"
    "property double y\n"
    "property int16 z\n"
    "property list ushort float32 weights\n"
    "element face 2\n"
    "property uchar label\n"
    "property list uint8 int vertex_indices\n"
    "element edge 1\n"
    "property int vertex1\n"
    "end_header\n";

const Positions positions_of_quad{{-1.5, -0.1, -300}, {1, -1, 0}, {1, 1, 2}, {0.25, 1, 7}};

std::string text_quad() {
  return "ply\nformat ascii 1.0\n" + header_of_quad +
         "1 0\n2 3 0.5 nan 1e3\n"
         "-1.5 255 -0.1 -300 0\n"
         "1 0 -1 0 1 0.5\n"
         "1 0 1 2 0\n"
         "0.25 0 1 7 2 1 2\n"
         "9 4 0 1 2 3\n"
         "9 3 3 1 0\n"
         "7\n";
}

std::string binary_quad(std::endian order) {
  std::string bytes = "ply\nformat binary_";
  bytes += (order == std::endian::little ? "little" : "big");
  bytes += "_endian 1.0\n" + header_of_quad;
  const auto u8 = [&](int value) { put(bytes, static_cast<std::uint8_t>(value), order); };
  const auto vertex = [&](float x, double y, std::int16_t z, std::vector<float> weights) {
    put(bytes, x, order);
    u8(200);
    put(bytes, y, order);
    put(bytes, z, order);
    put(bytes, static_cast<std::uint16_t>(weights.size()), order);
    for (const float weight : weights) put(bytes, weight, order);
  };
  const auto face = [&](std::vector<std::int32_t> corners) {
    u8(9);
    u8(static_cast<int>(corners.size()));
    for (const std::int32_t corner : corners) put(bytes, corner, order);
  };
  u8(1), u8(0);
  u8(2), u8(1), put(bytes, 0.5, order);
  vertex(-1.5f, -0.1, -300, {});
  vertex(1, -1, 0, {0.5f});
  vertex(1, 1, 2, {});
  vertex(0.25f, 1, 7, {1, 2});
  face({0, 1, 2, 3});
  face({3, 1, 0});
  put(bytes, std::int32_t{7}, order);
  return bytes;
}

std::string triangle(std::string_view vertices, std::string_view faces, std::string_view format = "ascii") {
  std::string text = "ply\nformat " + std::string(format) + " 1.0\nelement vertex 3\n";
  text += "property float x\nproperty float y\nproperty float z\nelement face 1\n";
  text += "property list uchar int vertex_indices\nend_header\n";
  text += vertices;
  text += faces;
  return text;
}

const std::string three = "0 0 0\n1 0 0\n1 1 0\n";

}  // namespace

TEST_CASE("PLY: text and both binaries give the same mesh, whatever else the file holds") {
  for (const std::string& bytes : {text_quad(), binary_quad(std::endian::little), binary_quad(std::endian::big)}) {
    const voml::Mesh mesh = mesh_of("any name", bytes);
    CHECK(mesh.positions == positions_of_quad);
    CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 2, 3}, {3, 1, 0}});
  }
}

TEST_CASE("PLY: the property may be named vertex_index; lines may end in CR LF; faces may come first") {
  const voml::Mesh mesh = mesh_of("a.ply",
                                  "ply\r\nformat ascii 1.0\r\nelement face 1\r\n"
                                  "property list int16 uint32 vertex_index\r\nelement vertex 3\r\n"
                                  "property double z\r\nproperty double y\r\nproperty double x\r\nend_header\r\n"
                                  "3 2 1 0\r\n1 2 3\r\n4 5 6\r\n7 8 9");
  CHECK(mesh.positions == Positions{{3, 2, 1}, {6, 5, 4}, {9, 8, 7}});
  CHECK(mesh.triangles == Triangles{{2, 1, 0}});
}

TEST_CASE("PLY: faults of the header are named with line and column") {
  const auto header = [](std::string_view lines) { return "ply\n" + std::string(lines); };
  const std::string vertex = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string ascii = "format ascii 1.0\n";
  check_refused_at("a.ply", "plyx\n", Code::mesh_syntax, 1, 1);
  check_refused_at("a.ply", "solid rock\n", Code::mesh_syntax, 1, 1);
  check_refused_at("a.ply", header("format asci 1.0\n"), Code::mesh_syntax, 2, 8);
  check_refused_at("a.ply", header("format ascii 2.0\n"), Code::mesh_syntax, 2, 14);
  check_refused_at("a.ply", header("elements\n"), Code::mesh_syntax, 2, 1);
  check_refused_at("a.ply", header("element vertex -3\n"), Code::mesh_syntax, 2, 16);
  check_refused_at("a.ply", header("element vertex\n"), Code::mesh_syntax, 2, 15);
  check_refused_at("a.ply", header("element vertex 99999999999999999999\n"), Code::mesh_syntax, 2, 16);
  check_refused_at("a.ply", header("property float x\n"), Code::mesh_syntax, 2, 1);
  check_refused_at("a.ply", header("element vertex 3\nproperty half x\n"), Code::mesh_syntax, 3, 10);
  check_refused_at("a.ply", header("element face 3\nproperty list float int vertex_indices\n"), Code::mesh_syntax, 3,
                   15);
  check_refused_at("a.ply", header(ascii + vertex), Code::mesh_truncated, 7, 1);
  check_refused_at("a.ply", header(vertex + face + "end_header\n"), Code::mesh_syntax, 8, 1);
  check_refused_at("a.ply", header(ascii + vertex + "end_header\n" + three), Code::mesh_syntax, 7, 1);
  check_refused_at("a.ply", header(ascii + vertex + face + face + "end_header\n" + three), Code::mesh_syntax, 11, 1);
  check_refused_at(
      "a.ply", header(ascii + "element vertex 1\nproperty float x\nproperty float y\n" + face + "end_header\n0 0\n"),
      Code::mesh_syntax, 3, 9);
  check_refused_at("a.ply",
                   header(ascii + vertex + "element face 1\nproperty list uchar float vertex_indices\nend_header\n" +
                          three + "3 0 1 2"),
                   Code::mesh_syntax, 7, 9);
}

TEST_CASE("PLY: faults of text data are named with line and column") {
  check_refused_at("a.ply", triangle("0 0 0\n1 0 0\n1 one 0\n", "3 0 1 2\n"), Code::mesh_syntax, 12, 3);
  check_refused_at("a.ply", triangle("0 0 0\n1 0 0\n1 nan 0\n", "3 0 1 2\n"), Code::mesh_number_not_finite, 12, 3);
  check_refused_at("a.ply", triangle(three, "3 0 1 3\n"), Code::mesh_index_out_of_range, 13, 7);
  check_refused_at("a.ply", triangle(three, "3 0 -1 2\n"), Code::mesh_index_out_of_range, 13, 5);
  check_refused_at("a.ply", triangle(three, "2 0 1\n"), Code::mesh_syntax, 13, 1);
  check_refused_at("a.ply", triangle(three, "-3 0 1 2\n"), Code::mesh_syntax, 13, 1);
  check_refused_at("a.ply", triangle(three, "2000000000 0 1 2\n"), Code::mesh_truncated, 13, 1);
  check_refused_at("a.ply", triangle(three, "3 0 1"), Code::mesh_truncated, 13, 1);    // three numbers do not fit
  check_refused_at("a.ply", triangle(three, "3 0   1"), Code::mesh_truncated, 13, 8);  // they might have
}

TEST_CASE("PLY: counts that the file cannot hold are refused before memory is asked for") {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    std::string text = triangle(three, "3 0 1 2\n", format);
    text.replace(text.find("vertex 3"), 8, "vertex 4000000000000000000");
    check_refused_at("a.ply", text, Code::mesh_truncated, 3, 9);
  }
  std::string no_properties = triangle(three, "3 0 1 2\n");
  no_properties.insert(no_properties.find("element vertex"), "element ghost 9000000000000000000\n");
  CHECK(mesh_of("a.ply", no_properties).triangles.size() == 1);
}

TEST_CASE("PLY: faults of binary data are named with their byte") {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string format = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
    const auto file = [&](std::vector<float> coordinates, std::vector<std::int32_t> corners) {
      std::string bytes = triangle("", "", format);
      for (const float coordinate : coordinates) put(bytes, coordinate, order);
      put(bytes, static_cast<std::uint8_t>(corners.size()));
      for (const std::int32_t corner : corners) put(bytes, corner, order);
      return bytes;
    };
    const std::size_t data = triangle("", "", format).size();
    const std::vector<float> good{0, 0, 0, 1, 0, 0, 1, 1, 0};
    CHECK(mesh_of("a.ply", file(good, {0, 1, 2})).positions == Positions{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}});
    check_refused_at_byte("a.ply", file({0, 0, 0, 1, 0, INFINITY, 1, 1, 0}, {0, 1, 2}), Code::mesh_number_not_finite,
                          data + 5 * 4);
    check_refused_at_byte("a.ply", file(good, {0, 3, 2}), Code::mesh_index_out_of_range, data + 9 * 4 + 1 + 4);
    check_refused_at_byte("a.ply", file(good, {0, 1, -1}), Code::mesh_index_out_of_range, data + 9 * 4 + 1 + 8);
    check_refused_at_byte("a.ply", file(good, {0, 1}), Code::mesh_syntax, data + 9 * 4);
  }
}

TEST_CASE("PLY: a file cut off anywhere is refused") {
  std::string text = text_quad();
  text.pop_back();  // the line end behind the last value may be missing
  for (const std::string& bytes : {text, binary_quad(std::endian::little), binary_quad(std::endian::big)}) {
    for (std::size_t size = 4; size < bytes.size(); ++size) {
      CAPTURE(size);
      refusal_of(parse("a.ply", std::string_view(bytes).substr(0, size)));
    }
  }
}

}  // namespace dmvv::tests
