#include "tests/random/report.h"

#include <fmt/format.h>

#include <cmath>

namespace dmvv::tests::random_scenes {

namespace {

constexpr std::size_t most_tries = 1500;

std::string_view name(Fault::Kind kind) {
  switch (kind) {
    case Fault::Kind::refused:
      return "a valid scene is refused";
    case Fault::Kind::spirv:
      return "a shader does not compile";
    case Fault::Kind::lookup:
      return "a lookup changes the reference's answer";
    case Fault::Kind::meaning:
      return "the reference differs from the specification";
    case Fault::Kind::device:
      return "the device fails";
    case Fault::Kind::validation:
      return "the validation layer complains";
    case Fault::Kind::answer:
      return "a shader differs from the reference, which is certain";
    case Fault::Kind::verdict:
      return "a verdict differs from the reference, which is certain";
  }
  return "";
}

/// The first line of a message tells one refusal from another.
std::string first_error(const std::string& text) {
  const std::size_t at = text.find("error[");
  return at == std::string::npos ? text.substr(0, 40) : text.substr(at, 12);
}

/// A file by its size, and its text if it has one.
std::string summary(const std::string& path, const std::string& bytes) {
  if (path.ends_with(".lxn")) {
    Diagnostics diagnostics;
    const auto grid = voml::parse_lxn(bytes, diagnostics.add_source(path, {}), diagnostics);
    std::string text;
    for (std::size_t i = 0; i < grid->values.size() && i < 64; ++i) text += fmt::format(" {}", grid->values[i]);
    return fmt::format("grid {} x {} x {} in [{} {} {}] to [{} {} {}]:{}", grid->size.x, grid->size.y, grid->size.z,
                       grid->box_lo.x, grid->box_lo.y, grid->box_lo.z, grid->box_hi.x, grid->box_hi.y, grid->box_hi.z,
                       text);
  }
  if (path.ends_with(".png")) return fmt::format("bitmap, {} bytes", bytes.size());
  return bytes.substr(0, 4000);
}

}  // namespace

Shrunk shrink_fault(runtime::Device& device, Scene scene, std::uint64_t seed, const Fault& fault,
                    const CheckOptions& options) {
  Shrunk shrunk{std::move(scene), fault};
  Counts counts;
  const auto fails_at = [&](const Scene& candidate, std::vector<glm::dvec3> points) {
    const Focus focus{shrunk.fault, std::move(points)};
    const auto found = check(device, candidate, seed, options, counts, &focus);
    if (!found || found->kind != fault.kind) return false;
    if (fault.kind == Fault::Kind::refused && first_error(found->got) != first_error(fault.got)) return false;
    shrunk.fault = *found;
    return true;
  };
  shrunk.scene = shrink(
      shrunk.scene,
      [&](const Scene& candidate) {
        if (shrunk.fault.point && fails_at(candidate, {*shrunk.fault.point})) return true;
        return fails_at(candidate, {});
      },
      most_tries);
  if (!shrunk.fault.point) return shrunk;
  for (const double steps : {1.0, 2.0, 8.0, 64.0, 1024.0, 65536.0}) {  // rounded to float32 values
    const glm::dvec3 rounder = glm::round(*shrunk.fault.point * steps) / steps;
    if (fails_at(shrunk.scene, {rounder})) break;
  }
  return shrunk;
}

std::string describe(const Shrunk& shrunk) {
  std::string text;
  for (const auto& [path, bytes] : print(shrunk.scene)) {
    const bool voml = path.ends_with(".voml");
    text += fmt::format("---- {}\n{}{}", path, voml ? bytes : summary(path, bytes), voml ? "" : "\n");
  }
  const Fault& fault = shrunk.fault;
  text += fmt::format("---- {}\nsetting {}, {} ms", name(fault.kind), fault.setting, fault.time_ms);
  if (fault.point) text += fmt::format(", at {} {} {}", fault.point->x, fault.point->y, fault.point->z);
  if (!fault.expected.empty()) text += fmt::format("\nexpected {}", fault.expected);
  return text + fmt::format("\ngot      {}\n", fault.got);
}

}  // namespace dmvv::tests::random_scenes
