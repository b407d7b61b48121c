// Writes the seeds of the sticks and the support mesh, a ball.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "examples/spread.h"

namespace {

using glm::dvec3;
const double pi = std::acos(-1.0);

/// 1,000 sticks, evenly in a ball of radius 0.84.
bool write_seeds(const std::string& folder) {
  examples::VectorFile places(folder + "/sticks.txt"), rotations(folder + "/sticks_rotate.txt");
  examples::Random random;
  for (const dvec3& u : examples::spread(glm::ivec3(10), random)) {
    const double r = 0.84 * std::cbrt(u.x), z = 2.0 * u.y - 1.0, s = std::sqrt(1.0 - z * z);
    places.add(0.5 * r * dvec3(s * std::cos(2.0 * pi * u.z), z, s * std::sin(2.0 * pi * u.z)));  // of the cube's edge
    rotations.add(random.rotation());
  }
  return places.close() && rotations.close();
}

/// A closed ball around the y axis: two poles and `rings` - 1 circles of 2 * `rings` vertices.
bool write_ball(const std::string& path, double radius, int rings) {
  std::ofstream file(path);
  file.precision(9);
  const int around = 2 * rings;
  file << "v 0 " << radius << " 0\n";
  for (int ring = 1; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      const double polar = pi * ring / rings, azimuth = 2.0 * pi * i / around;
      file << "v " << radius * std::sin(polar) * std::sin(azimuth) << ' ' << radius * std::cos(polar) << ' '
           << radius * std::sin(polar) * std::cos(azimuth) << '\n';
    }
  }
  file << "v 0 " << -radius << " 0\n";

  const auto vertex = [&](int ring, int i) {  // OBJ counts from 1
    if (ring == 0) return 1;
    return ring == rings ? (rings - 1) * around + 2 : 2 + (ring - 1) * around + i % around;
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      const int a = vertex(ring, i), b = vertex(ring + 1, i), c = vertex(ring + 1, i + 1), d = vertex(ring, i + 1);
      if (b != c) file << "f " << a << ' ' << b << ' ' << c << '\n';
      if (a != d) file << "f " << a << ' ' << c << ' ' << d << '\n';
    }
  }
  file.close();
  return !file.fail();
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) {
    std::fputs("usage: make_sticks FOLDER\n", stderr);
    return 2;
  }
  const std::string folder = words[1];
  const bool written = write_seeds(folder) && write_ball(folder + "/ball.obj", 0.86, 64);
  if (!written) std::fprintf(stderr, "make_sticks: cannot write to %s\n", words[1]);
  return written ? 0 : 1;
}
