// Mutated files of every format: each gives a sound mesh or exactly one error, and never a crash.
#include <cmath>
#include <random>

#include "tests/unit/mesh/mesh_test.h"

namespace dmvv::tests {

namespace {

struct File {
  std::string path;
  std::string bytes;
};

std::vector<File> good_files() {
  const std::string header =
      " 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty double y\nproperty short z\n"
      "property list uchar int tags\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n";
  std::vector<File> files{
      {"a.off", "OFF # c\n3 1 0\n0 0 0\n1 0 0.5\n1e0 1 -0\n3 0 1 2 255 0 0\n"},
      {"b.off", "COFF\n4 2 5\n0 0 0 1 0 0\n1 0 0 1 0 0\n1 1 0 9 9 9\n0 1 0 0 0 0\n4 0 1 2 3\n2 0 1\n"},
      {"a.obj", "# c\nv 0 0 0\nv 1 0 0.5 1\nv 1e0 +1 \\\n0\nvn 0 0 1\nf 1//1 2 3/1/1\nf -3 -2 -1 1\n"},
      {"a.ply", "ply\nformat ascii" + header + "0 0 0 1 7\n1 0 0 0\n1 1 0 2 1 2\n3 0 1 2\n"},
      {"a.stl",
       "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
       "endsolid x\n"}};
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    std::string bytes =
        std::string("ply\nformat binary_") + (order == std::endian::little ? "little" : "big") + "_endian" + header;
    for (int v = 0; v < 3; ++v) {
      put(bytes, static_cast<float>(v), order);
      put(bytes, 0.5 * v * v, order);
      put(bytes, static_cast<std::int16_t>(-v), order);
      put(bytes, std::uint8_t{1}, order);
      put(bytes, std::int32_t{v}, order);
    }
    put(bytes, std::uint8_t{3}, order);
    for (std::uint32_t v = 0; v < 3; ++v) put(bytes, v, order);
    files.push_back({"b.ply", bytes});
  }
  std::string stl("solid or not");
  stl.resize(80);
  put(stl, std::uint32_t{2});
  for (int i = 0; i < 24; ++i) put(stl, static_cast<float>(i % 5));
  stl.insert(84 + 48, 2, '\0');
  stl.append(2, '\0');
  files.push_back({"b.stl", stl});
  return files;
}

/// A few random changes: bytes replaced by digits, signs or anything, pieces dropped, doubled or moved.
std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  static constexpr std::string_view likely = "0123456789-+/.e \n\r\\#\xff\x7f\x80";
  for (std::size_t changes = 1 + below(4); changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = below(bytes.size());
    const std::size_t length = 1 + below(std::min<std::size_t>(bytes.size() - at, 12));
    switch (below(5)) {
      case 0:
        bytes[at] = likely[below(likely.size())];
        break;
      case 1:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(below(bytes.size()), bytes.substr(at, length));
        break;
      default:
        bytes.resize(at);
        break;
    }
  }
  return bytes;
}

void check_sound(const voml::Mesh& mesh) {
  bool sound = !mesh.triangles.empty();
  for (const glm::dvec3& p : mesh.positions) {
    sound = sound && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }
  for (const glm::uvec3& t : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) sound = sound && t[corner] < mesh.positions.size();
  }
  REQUIRE(sound);
  voml::find_edge_faults(mesh).count();
}

}  // namespace

TEST_CASE("mutated mesh files give a sound mesh or one error") {
  std::mt19937 random(20240229);
  std::size_t meshes = 0, refusals = 0;
  for (const File& file : good_files()) {
    check_sound(mesh_of(file.path, file.bytes));
    for (int round = 0; round < 5000; ++round) {
      const Parsed parsed = parse(file.path, mutated(file.bytes, random));
      if (parsed.mesh) {
        check_sound(*parsed.mesh);
        REQUIRE_FALSE(parsed.diagnostics.has_errors());
        ++meshes;
      } else {
        REQUIRE(parsed.diagnostics.error_count() == 1);
        REQUIRE_FALSE(parsed.diagnostics.render().empty());
        ++refusals;
      }
    }
  }
  // Both ways out must have been taken, or the mutations test nothing.
  CHECK(meshes > 1000);
  CHECK(refusals > 1000);
}

}  // namespace dmvv::tests
