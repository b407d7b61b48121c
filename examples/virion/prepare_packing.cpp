// Prepares the packing of the mature HIV-1 particle for `dmvv seeds`: prepare_packing PACKING.json PREPARED.json
//
// The file places each of the 1,356 capsid monomers by the coordinates of the chain it came from, which lies 1,150 A
// off the origin, but gives its beads round the origin, and with the size of a hexamer. Here the beads stand at the
// monomer's own place, at a sixth of their volume. Ingredients within the capsid get names of their own: CORE_....
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using Json = nlohmann::ordered_json;

/// Where the middle of a monomer lies in the coordinates of its chain, in A. Not in the file, but determined by it: it
/// is where the least distance between two of the 1,356 placed points is greatest, 31.2 A. Nearest neighbours are
/// then 31.2 to 36.9 A apart, and all lie within the envelope; off by 50 A along the chain's axis, some come as near as
/// 7 A.
constexpr double monomer[3] = {413.3619, 999.6703, 381.8548};

/// Of a hexamer's volume.
const double bead_scale = std::cbrt(1.0 / 6.0);

/// v + R(q) * monomer, q = (w, x, y, z) of unit length.
Json moved(const Json& v, const Json& q) {
  const double w = q[0], u[3] = {q[1], q[2], q[3]};
  double t[3];
  for (int i = 0; i < 3; ++i)
    t[i] = 2.0 * (u[(i + 1) % 3] * monomer[(i + 2) % 3] - u[(i + 2) % 3] * monomer[(i + 1) % 3]);
  Json result = Json::array();
  for (int i = 0; i < 3; ++i) {
    result.push_back(v[static_cast<std::size_t>(i)].get<double>() + monomer[i] + w * t[i] +
                     u[(i + 1) % 3] * t[(i + 2) % 3] - u[(i + 2) % 3] * t[(i + 1) % 3]);
  }
  return result;
}

void place_capsid(Json& ingredient) {
  for (Json& placement : ingredient.at("results")) placement.at(0) = moved(placement.at(0), placement.at(1));
  for (Json& bead : ingredient.at("positions").at(0))
    for (Json& coordinate : bead) coordinate = coordinate.get<double>() * bead_scale;
  for (Json& radius : ingredient.at("radii").at(0)) radius = radius.get<double>() * bead_scale;
}

void name_core(Json& compartment) {
  Json named = Json::object();
  for (auto& [name, ingredient] : compartment.at("interior").at("ingredients").items())
    named["CORE_" + name] = std::move(ingredient);
  compartment["interior"]["ingredients"] = std::move(named);
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fputs("usage: prepare_packing PACKING.json PREPARED.json\n", stderr);
    return 2;
  }
  try {
    std::ifstream input(words[1], std::ios::binary);
    Json packing = Json::parse(std::string(std::istreambuf_iterator<char>(input), {}));
    Json& compartments = packing.at("compartments");
    place_capsid(
        compartments.at("HIV1_capsid_3j3q_PackOuter_0_1_1").at("surface").at("ingredients").at("HIV1_CA_mono_0_1_0"));
    name_core(compartments.at("HIV1_capsid_3j3q_PackInner_0_1_0"));
    std::ofstream output(words[2], std::ios::binary);
    output << packing.dump();
    output.close();
    if (output) return 0;
    std::fprintf(stderr, "prepare_packing: cannot write to %s\n", words[2]);
  } catch (const Json::exception& error) {
    std::fprintf(stderr, "prepare_packing: %s: %s\n", words[1], error.what());
  }
  return 1;
}
