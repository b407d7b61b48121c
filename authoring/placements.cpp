#include "authoring/placements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>
#include <set>

#include "base/text.h"

namespace dmvv::authoring {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

double largest_entry(const glm::dmat3& m) {
  double largest = 0.0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) largest = std::max(largest, std::abs(m[column][row]));
  return largest;
}

}  // namespace

std::optional<Rotation> nearest_rotation(const glm::dmat3& matrix) {
  const double fault = largest_entry(glm::transpose(matrix) * matrix - glm::dmat3(1.0));
  if (!(fault <= hopeless_rotation) || !(glm::determinant(matrix) > 0.0)) return std::nullopt;
  glm::dmat3 x = matrix;
  for (int step = 0; step < 20; ++step) {  // converges quadratically
    const glm::dmat3 next = 0.5 * (x + glm::transpose(glm::inverse(x)));
    const double change = largest_entry(next - x);
    x = next;
    if (change < 1e-15) break;
  }
  return Rotation{x, fault};
}

std::optional<Rotation> quaternion_rotation(double w, double x, double y, double z) {
  const double square = w * w + x * x + y * y + z * z;
  const double fault = std::abs(square - 1.0);
  if (!(fault <= hopeless_rotation)) return std::nullopt;
  const double s = 2.0 / square;
  return Rotation{{{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
                   {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
                   {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}},
                  fault};
}

glm::dmat3 euler_rotation(const glm::dvec3& angles_deg) {
  const glm::dvec3 a = angles_deg * degree;
  const double cx = std::cos(a.x), sx = std::sin(a.x), cy = std::cos(a.y), sy = std::sin(a.y), cz = std::cos(a.z),
               sz = std::sin(a.z);
  return glm::dmat3(cz, sz, 0, -sz, cz, 0, 0, 0, 1) * glm::dmat3(cy, 0, -sy, 0, 1, 0, sy, 0, cy) *
         glm::dmat3(1, 0, 0, 0, cx, sx, 0, -sx, cx);
}

glm::dvec3 euler_angles_deg(const glm::dmat3& r) {
  const double z = std::atan2(r[0][1], r[0][0]);
  const double y = std::atan2(-r[0][2], std::hypot(r[0][0], r[0][1]));
  // The middle row of Rz^T R = Ry Rx is (0, cos x, -sin x), also where y is 90 degrees and z is free.
  const double sz = std::sin(z), cz = std::cos(z);
  const double x = std::atan2(sz * r[2][0] - cz * r[2][1], cz * r[1][1] - sz * r[1][0]);
  return glm::dvec3(x, y, z) / degree;
}

MoleculeFrame fit_placements(std::span<const Placement> placements) {
  glm::dvec3 lo = placements.front().position, hi = lo;
  for (const Placement& placement : placements) {
    const glm::dmat3& r = placement.rotation;
    const glm::dvec3 half =
        glm::abs(r[0] * placement.scale.x) + glm::abs(r[1] * placement.scale.y) + glm::abs(r[2] * placement.scale.z);
    lo = glm::min(lo, placement.position - half);
    hi = glm::max(hi, placement.position + half);
  }
  const glm::dvec3 half = 0.5 * (hi - lo);
  return {0.5 * (lo + hi), std::max({half.x, half.y, half.z}) / 0.95};
}

PlacementFiles placement_files(std::span<const Placement> placements, const MoleculeFrame& frame) {
  PlacementFiles files;
  for (const Placement& placement : placements) {
    const glm::dvec3 p = (placement.position - frame.center) / (2.0 * frame.angstrom_per_unit);
    const glm::dvec3 a = euler_angles_deg(placement.rotation);
    const glm::dvec3 s = placement.scale / frame.angstrom_per_unit;
    files.seeds += fmt::format("{:.9f} {:.9f} {:.9f}\n", p.x, p.y, p.z);
    files.rotates += fmt::format("{:.7f} {:.7f} {:.7f}\n", a.x, a.y, a.z);
    files.scales += fmt::format("{:.9g} {:.9g} {:.9g}\n", s.x, s.y, s.z);
  }
  return files;
}

PlacedAssembly place_assembly(const Molecule& molecule, const Assembly& assembly) {
  PlacedAssembly result;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  glm::dvec3 lo(infinity), hi(-infinity);
  for (const AssemblyPart& part : assembly.parts) {
    PlacedUnit unit{atoms_of(molecule, part), {}, {}};
    if (unit.atoms.empty() || part.operators.empty()) continue;
    unit.frame = fit_molecule(unit.atoms);
    for (const Operator& op : part.operators) {
      unit.placements.push_back(
          {op.rotation * unit.frame.center + op.translation, op.rotation, glm::dvec3(unit.frame.angstrom_per_unit)});
      for (const Atom& atom : unit.atoms) {
        const glm::dvec3 p = op.rotation * atom.position + op.translation;
        lo = glm::min(lo, p - atom.element->radius);
        hi = glm::max(hi, p + atom.element->radius);
      }
    }
    result.units.push_back(std::move(unit));
  }
  const glm::dvec3 half = 0.5 * (hi - lo);
  result.frame = {0.5 * (lo + hi), std::max({half.x, half.y, half.z}) / 0.95};
  return result;
}

std::string file_name_of(std::string_view name) {
  std::string result;
  bool any = false;
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    any |= letter;
    result += letter || c == '-' || c == '.' ? c : '_';
  }
  return any ? result.substr(0, 100) : "kind";
}

std::vector<std::string> file_names_of(std::span<const std::string> names) {
  std::set<std::string> taken{"all", "filled"};  // the objects that hold them
  std::vector<std::string> result;
  for (const std::string& name : names) {
    const std::string plain = file_name_of(name);
    std::string unique = plain;
    const auto free = [&] {
      const std::string lower = lower_case(unique);
      return !taken.contains(lower) && !taken.contains(lower + "_rotate") && !taken.contains(lower + "_scale") &&
             !taken.contains(lower + "_bead");
    };
    for (int i = 2; !free(); ++i) unique = fmt::format("{}_{}", plain, i);
    for (const char* const ending : {"", "_rotate", "_scale", "_bead", "_bead_scale"})
      taken.insert(lower_case(unique) + ending);
    result.push_back(unique);
  }
  return result;
}

std::string kind_rgb(std::size_t i) {
  const double turn = std::fmod(0.05 + 0.6180339887498949 * static_cast<double>(i), 1.0) * 6.0;
  const double value = i % 2 == 0 ? 0.9 : 0.7, saturation = i / 2 % 2 == 0 ? 0.75 : 0.5;
  const auto channel = [&](double n) {
    const double k = std::fmod(n + turn, 6.0);
    return value - value * saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0);
  };
  return fmt::format("{:.3f} {:.3f} {:.3f}", channel(5), channel(3), channel(1));
}

std::string for_comment(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '-' && result.ends_with('-') ? " -" : std::string(1, c);
  return result;
}

std::string for_attribute(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

std::string placed_scene(std::span<const PlacedObject> objects, const std::string& stem, std::string_view comment) {
  std::string text, embedded;
  std::size_t count = 0;
  for (const PlacedObject& object : objects) {
    count += object.count;
    text += object.object;
    embedded += fmt::format(
        "        <EMBEDDED name=\"{0}\" seedFile=\"{1}_{0}.txt\" rotateFile=\"{1}_{0}_rotate.txt\""
        " scaleFile=\"{1}_{0}_scale.txt\"/>\n",
        object.name, for_attribute(stem));
  }
  const int cells = std::clamp(static_cast<int>(std::ceil(std::cbrt(static_cast<double>(count)))), 1, 64);
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- {}. Made by `dmvv seeds`. -->
<MVV>
{}  <!-- For pictures by a support mesh, which may pass between the things: dmvv render with root FILLED. -->
  <OBJECT name="FILLED">
    <REGION name="R.BETWEEN" type="color" rgb="0.800 0.870 0.910"><EMBEDDED name="ALL"/></REGION>
  </OBJECT>
  <OBJECT name="ALL">
    <REGION name="R.ALL" type="empty">
      <INDEX size="{} {} {}">
{}      </INDEX>
    </REGION>
  </OBJECT>
</MVV>
)",
                     for_comment(comment), text, cells, cells, cells, embedded);
}

std::string simple_object(const std::string& name, const std::string& rgb, bool box) {
  return fmt::format(
      "  <OBJECT name=\"{0}\">\n    <SDF name=\"SHAPE\" function=\"true\">{2}</SDF>\n"
      "    <REGION name=\"R.SHAPE\" type=\"color\" rgb=\"{1}\"/>\n  </OBJECT>\n",
      name, rgb,
      box ? "vec3 d = abs(p) - vec3(0.8, 0.5, 0.3); "
            "return length(max(d, vec3(0.0))) + min(max(d.x, max(d.y, d.z)), 0.0) - 0.1;"
          : "return length(p) - 0.9;");
}

}  // namespace dmvv::authoring
