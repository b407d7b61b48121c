// Writes the seeds of the metaballs: 4,000 for each half of the cube, or (--grains) 10,000 for each metaball.
#include <cstdio>
#include <string>

#include "examples/spread.h"

namespace {

using examples::Random;
using examples::VectorFile;
using glm::dvec3;

/// Seed, rotate and scale file of one list.
struct Seeds {
  explicit Seeds(const std::string& path)
      : places(path + ".txt"), rotations(path + "_rotate.txt"), scales(path + "_scale.txt") {}

  /// `position` in object coordinates; seed files hold fractions of the cube's edge.
  void add(const dvec3& position, const dvec3& rotation, double scale) {
    places.add(position * 0.5);
    rotations.add(rotation);
    scales.add(dvec3(scale));
  }
  bool close() { return places.close() && rotations.close() && scales.close(); }

  VectorFile places, rotations, scales;
};

/// A crystal of 10 x 20 x 20: each pair lies across its six neighbours, so that there is room for both.
bool write_crystal(const std::string& folder) {
  Seeds seeds(folder + "/crystal");
  for (int z = 0; z < 20; ++z) {
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 10; ++x) {
        seeds.add(dvec3(-0.95 + 0.1 * x, -0.95 + 0.1 * y, -0.95 + 0.1 * z), {0, 0, (x + y + z) % 2 * 90.0}, 0.075);
      }
    }
  }
  return seeds.close();
}

/// A fluid: evenly spread, turned and sized in every way.
bool write_fluid(const std::string& folder) {
  Seeds seeds(folder + "/fluid");
  Random random;
  for (const dvec3& u : examples::spread({10, 20, 20}, random)) {
    const dvec3 place = dvec3(0.0, -1.0, -1.0) + u * dvec3(1.0, 2.0, 2.0);
    const dvec3 rotation = random.rotation();
    seeds.add(place, rotation, random.uniform(0.07, 0.1));
  }
  return seeds.close();
}

/// Grains in the space that one metaball can ever reach: x from 0 to 0.98 on its side, 0.58 around the axis.
bool write_grains(const std::string& folder, const std::string& name, double side) {
  Seeds seeds(folder + "/" + name);
  Random random;
  for (const dvec3& u : examples::spread({20, 25, 20}, random)) {
    const dvec3 place = dvec3(0.0, -0.58, -0.58) + u * dvec3(0.98, 1.16, 1.16);
    const dvec3 rotation = random.rotation();
    seeds.add({side * place.x, place.y, place.z}, rotation, random.uniform(0.016, 0.032));
  }
  return seeds.close();
}

}  // namespace

int main(int count, char** words) {
  const bool grains = count == 3 && std::string(words[2]) == "--grains";
  if (count != 2 && !grains) {
    std::fputs("usage: make_metaballs FOLDER [--grains]\n", stderr);
    return 2;
  }
  const std::string folder = words[1];
  const bool written = grains ? write_grains(folder, "warm_grains", 1) && write_grains(folder, "cool_grains", -1)
                              : write_crystal(folder) && write_fluid(folder);
  if (!written) std::fprintf(stderr, "make_metaballs: cannot write to %s\n", words[1]);
  return written ? 0 : 1;
}
