// Records read from texels (pass `texel-records`) and from storage buffers: the same answers, bit by bit.
#include <doctest/doctest.h>

#include <algorithm>

#include "runtime/runtime.h"
#include "shaders/records.h"
#include "tests/support/agreement.h"
#include "tests/support/scene_table.h"

using namespace dmvv;
using compiler::BufferForm;
using compiler::CompileOptions;

namespace {

CompileOptions with_texels(std::uint32_t most) {
  CompileOptions options;
  options.max_texel_buffer_elements = most;
  return options;
}

/// Whatever can be a tape is one.
CompileOptions all_tapes(CompileOptions options) {
  options.tapes.least_size = 0;
  options.tapes.walking_cost = 0.0;
  return options;
}

std::size_t texel_buffers(const compiler::Program& program) {
  return static_cast<std::size_t>(
      std::ranges::count_if(program.buffers, [](const auto& buffer) { return buffer.form != BufferForm::records; }));
}

bool is_lookup(const compiler::Buffer& buffer) {
  return buffer.binding == compiler::scene_binding::cells || buffer.binding == compiler::scene_binding::lists;
}

std::vector<compiler::PointAnswer> answers_of(runtime::Device& device, const compiler::Program& program,
                                              double time_ms) {
  tests::Random random(7);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 2000; ++i) points.push_back(glm::dvec3(glm::vec3(random.point(-1.05, 1.05))));
  auto evaluator = runtime::Evaluator::create(device, program);
  REQUIRE(evaluator);
  auto answers = evaluator->probe(points, time_ms);
  REQUIRE(answers);
  return std::move(*answers);
}

void check_equal(const std::vector<compiler::PointAnswer>& a, const std::vector<compiler::PointAnswer>& b) {
  REQUIRE(a.size() == b.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    different += a[i].number != b[i].number || a[i].path != b[i].path || a[i].rgba != b[i].rgba ? 1 : 0;
  }
  CHECK(different == 0);
}

}  // namespace

TEST_CASE("texels and storage buffers give the same answers") {
  auto device = runtime::Device::create({.name = "", .validation = true});
  REQUIRE(device);
  std::size_t programs = 0;
  for (const auto& scene : tests::conformance_scenes()) {
    CAPTURE(scene.name);
    const auto module = tests::lowered(scene.text, scene.files);
    for (const bool tapes : {false, true}) {
      const CompileOptions plain = tapes ? all_tapes({}) : CompileOptions{};
      const CompileOptions texels =
          tapes ? all_tapes(with_texels(tests::least_texel_buffer)) : with_texels(tests::least_texel_buffer);
      const auto expected = tests::compiled(module, plain), program = tests::compiled(module, texels);
      CHECK(texel_buffers(expected) == 0);
      if (texel_buffers(program) == 0) continue;
      ++programs;
      for (const double time_ms : tests::times_of(program)) {
        check_equal(answers_of(*device, program, time_ms), answers_of(*device, expected, time_ms));
      }
    }
  }
  CHECK(programs > 10);
  for (const auto& message : device->validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("a program with a buffer too large for texels has storage buffers, and so has every other form") {
  const auto& scene = tests::conformance_scene("two levels, second comes back empty");
  const auto module = tests::lowered(scene.text, scene.files);
  const auto program = tests::compiled(module, with_texels(tests::least_texel_buffer));
  CHECK(std::ranges::count_if(program.buffers, is_lookup) == 2);
  std::size_t longest = 0;
  for (const auto& buffer : program.buffers) {
    if (is_lookup(buffer)) CHECK(buffer.form == BufferForm::r32ui);
    if (buffer.binding == compiler::scene_binding::placements) CHECK(buffer.form == BufferForm::rgba32ui);
    if (buffer.form != BufferForm::records) {
      longest = std::max(longest, buffer.bytes.size() / compiler::bytes_per_texel(buffer.form));
    }
  }
  const auto most = static_cast<std::uint32_t>(longest);
  CHECK(texel_buffers(tests::compiled(module, with_texels(most))) == texel_buffers(program));
  CHECK(texel_buffers(tests::compiled(module, with_texels(most - 1))) == 0);
  CompileOptions off = with_texels(most);
  off.disabled_passes = {"texel-records"};
  CHECK(texel_buffers(tests::compiled(module, off)) == 0);
  CompileOptions table = with_texels(most);
  table.codegen = compiler::Codegen::table;
  CHECK(texel_buffers(tests::compiled(module, table)) == 0);
}
