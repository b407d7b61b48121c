// Scenes drawn from seeds on every evaluator, and whether the machinery that does it would notice a fault.
#include <doctest/doctest.h>

#include "tests/random/report.h"

using namespace dmvv;
using namespace dmvv::tests::random_scenes;

namespace {

const std::vector<NamedSnippet>& snippets() {
  static const auto all = read_snippets(DMVV_SOURCE_DIR "/tests/snippets");
  return all;
}

runtime::Device open_device() {
  auto device = runtime::Device::create({.name = "", .validation = true});
  REQUIRE_MESSAGE(device, device.error().message);
  return std::move(*device);
}

/// The first scene of moderate size from `seed` on that has a fault when `tamper` is at work, made small.
Shrunk found_with(const Tamper& tamper, std::uint64_t seed) {
  runtime::Device device = open_device();
  Counts counts;
  const CheckOptions options{40, false, tamper};
  for (;; ++seed) {
    const Scene scene = generate(seed, {});
    if (size(scene) > 60) continue;
    if (const auto fault = check(device, scene, seed, options, counts)) {
      CHECK(fault->kind == tests::random_scenes::Fault::Kind::answer);
      return shrink_fault(device, scene, seed, *fault, options);
    }
    REQUIRE(counts.scenes < 40);
  }
}

}  // namespace

TEST_CASE("scenes drawn from seeds mean the same on every evaluator") {
  constexpr std::uint64_t first = 700000, scenes = 24;
  runtime::Device device = open_device();
  Counts counts;
  const CheckOptions options{200, false, {}};
  for (std::uint64_t seed = first; seed < first + scenes; ++seed) {
    const Scene scene = generate(seed, snippets());
    if (const auto fault = check(device, scene, seed, options, counts)) {
      FAIL_CHECK("seed " << seed << ":\n" << describe(shrink_fault(device, scene, seed, *fault, options)));
    }
  }
  // Nearly every point of a cube is farther from all boundaries than float32 errors, and of the points on cube faces,
  // on centre planes and beside boundaries half are: or the promise says too little.
  CHECK(counts.uniform_uncertain * 20 < counts.uniform);
  CHECK(counts.other_uncertain * 2 < counts.other);
  CHECK(counts.answers > scenes * 2 * 100);
}

TEST_CASE("a seed gives one scene, and scenes have all of the language") {
  std::string all;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const auto files = print(generate(seed, snippets()));
    CHECK(files == print(generate(seed, snippets())));
    for (const auto& [path, bytes] : files) {
      if (path.ends_with(".voml")) all += bytes;
    }
  }
  for (const char* part : {"<IMPORT",
                           "<FUNCTIONS",
                           "#include <sdf>",
                           "shared_ring(p",
                           "<INDEX size",
                           "type=\"tiling\"",
                           "type=\"seeding\"",
                           "rotateFile",
                           "scaleFile",
                           "index=\"",
                           "offset=\"-",
                           "type=\"empty\"",
                           "type=\"bitmap\"",
                           "opacity=",
                           "scale=\"-",
                           "sin(t",
                           "<POSITIVE region",
                           "<![CDATA[",
                           "&lt;",
                           "float3",
                           "<mappings>",
                           ", "}) {
    CHECK_MESSAGE(all.find(part) != std::string::npos, part);
  }
}

TEST_CASE("a wrong answer in bitmaps is found and comes down to one bitmap") {
  const auto wrong_in_bitmaps = [](const compiler::Module& module, std::vector<compiler::PointAnswer>& answers) {
    for (auto& answer : answers) {
      for (const auto& region : module.regions) {
        if (region.kind == voml::RegionKind::bitmap && region.number == answer.number) answer.number += 1000;
      }
    }
  };
  const Shrunk shrunk = found_with(wrong_in_bitmaps, 100);
  const std::string text = describe(shrunk);
  CAPTURE(text);
  CHECK(size(shrunk.scene) <= 3);  // an object, its region, its tree
  CHECK(text.find("bitmap") != std::string::npos);
  CHECK(text.find("got      region 100") != std::string::npos);
}

TEST_CASE("a wrong answer two levels deep is found and comes down to three objects") {
  const auto wrong_deep_down = [](const compiler::Module&, std::vector<compiler::PointAnswer>& answers) {
    for (auto& answer : answers) {
      if (answer.path.size() >= 3) answer.rgba.g += 0.01;
    }
  };
  const Shrunk shrunk = found_with(wrong_deep_down, 200);
  CAPTURE(describe(shrunk));
  CHECK(shrunk.scene.objects.size() == 3);
  CHECK(size(shrunk.scene) <= 3 + 3 + 3 + 2);  // objects, regions, trees, embeddings
}
