// Programs written, loaded and run: what was loaded answers and draws as what was written.
#include "compiler/program_file.h"

#include <doctest/doctest.h>

#include <functional>
#include <set>

#include "compiler/layout/scene_buffers.h"
#include "runtime/runtime.h"
#include "tests/support/agreement.h"
#include "tests/support/scene_table.h"

using namespace dmvv;
using compiler::Program;

namespace {

runtime::Device& device() {
  static runtime::Device opened = runtime::Device::create({.name = "", .validation = true}).value();
  return opened;
}

std::vector<glm::dvec3> points() {
  tests::Random random(11);
  std::vector<glm::dvec3> all;
  for (int i = 0; i < 500; ++i) all.push_back(glm::dvec3(glm::vec3(random.point(-1.05, 1.05))));
  return all;
}

runtime::View view() {
  runtime::View view;
  view.size_px = {96, 64};
  view.camera.eye = {2.0, 1.5, 4.0};
  view.cuts = {{{0.0, 0.0, 1.0}, 0.1}};
  view.want_regions = true;
  return view;
}

void check_same(const Program& written, const Program& loaded) {
  auto expected = runtime::Evaluator::create(device(), written).value();
  auto got = runtime::Evaluator::create(device(), loaded).value();
  for (const double time_ms : tests::times_of(written)) {
    const auto answers = expected.probe(points(), time_ms), loaded_answers = got.probe(points(), time_ms);
    REQUIRE(answers);
    REQUIRE(loaded_answers);
    for (std::size_t i = 0; i < answers->size(); ++i) {
      CHECK((*answers)[i].number == (*loaded_answers)[i].number);
      CHECK((*answers)[i].path == (*loaded_answers)[i].path);
      CHECK((*answers)[i].rgba == (*loaded_answers)[i].rgba);
    }
    runtime::View at = view();
    at.time_ms = time_ms;
    const auto picture = expected.render(at), loaded_picture = got.render(at);
    REQUIRE(picture);
    REQUIRE(loaded_picture);
    CHECK(picture->regions == loaded_picture->regions);
    CHECK(picture->rgba == loaded_picture->rgba);
  }
}

/// A program with all that one can have: grids, bitmaps, time, lists, stages.
Program moving_program() {
  const auto& scene = tests::conformance_scene("two levels, second comes back empty");
  compiler::CompileOptions options;
  options.many_frames = true;
  return tests::compiled(tests::lowered(scene.text, scene.files), options);
}

std::string refusal(std::string_view bytes) {
  const auto read = compiler::read_program(bytes, "p.dmvv");
  REQUIRE_FALSE(read);
  CHECK(read.error().fault == Fault::input);
  return read.error().message;
}

/// Why a program that was changed before it was written is refused.
std::string refusal_of(Program program, const std::function<void(Program&)>& change) {
  change(program);
  return refusal(compiler::write_program(program));
}

}  // namespace

TEST_CASE("what was loaded answers and draws as what was written, and writes the same bytes") {
  for (const tests::SceneCase& scene : tests::conformance_scenes()) {
    CAPTURE(scene.name);
    const auto module = tests::lowered(scene.text, scene.files);
    for (const bool many_frames : {false, true}) {
      compiler::CompileOptions options;
      options.many_frames = many_frames;
      options.stages = {.least_program_lines = 0, .least_lines = 1};
      const Program written = tests::compiled(module, options);
      const std::string bytes = compiler::write_program(written);
      const auto loaded = compiler::read_program(bytes, "p.dmvv");
      REQUIRE_MESSAGE(loaded, loaded.error().message);
      CHECK(compiler::write_program(*loaded) == bytes);
      check_same(written, *loaded);
    }
  }
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}

TEST_CASE("a file that is short, long or changed anywhere is refused") {
  const std::string bytes = compiler::write_program(moving_program());
  CHECK(refusal("") == "cannot load 'p.dmvv': it is no compiled program of dmvv");
  CHECK(refusal("dmvv program\n") == "cannot load 'p.dmvv': it ends too early");
  for (std::size_t i = 0; i < bytes.size(); i += 1 + bytes.size() / 97) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    refusal(changed);
    refusal(std::string_view(bytes).substr(0, i));
  }
  CHECK(refusal(bytes + "x") == "cannot load 'p.dmvv': bytes are missing or were changed");
  std::string newer = bytes;
  newer[13] = 9;
  CHECK(refusal(newer) == "cannot load 'p.dmvv': its format is 9; this version reads 2");
}

TEST_CASE("a program whose parts do not fit each other is refused") {
  const auto& scene = tests::conformance_scene("analytic, moving");
  const Program program = tests::compiled(tests::lowered(scene.text, scene.files));
  REQUIRE_FALSE(program.time_slots.empty());
  using snippet_node = compiler::snippet::Node;
  const std::pair<std::string, std::function<void(Program&)>> cases[] = {
      {"it has the buffer 'cells' at no place of its own", [](Program& p) { p.buffers[0].name = "cells"; }},
      {"it has two things at one binding", [](Program& p) { p.buffers.push_back(p.buffers.back()); }},
      {"it has time values without their buffer", [](Program& p) { p.time_slots.pop_back(); }},
      {"it has an impossible depth or form", [](Program& p) { p.depth = 0; }},
      {"it has a kernel with no or too many shaders", [](Program& p) { p.kernels[0].shaders.clear(); }},
      {"that is no valid SPIR-V", [](Program& p) { p.kernels[0].shaders[0].spirv.resize(20); }},
      {"bytes for ", [](Program& p) { p.buffers[0].bytes.pop_back(); }},
      {"a result that is no float", [](Program& p) { p.time_slots[0].program.result = 1u << 30; }},
      {"an instruction whose operands it cannot have",
       [](Program& p) { p.time_slots[0].program.instructions.at(0).operands[0] = 12345; }},
      {"an instruction whose operands it cannot have",
       [](Program& p) { p.time_slots[0].program.instructions.at(0).result = 0; }},
      {"control flow that leads nowhere", [](Program& p) { p.time_slots[0].program.body.at(0).count = 99999; }},
      {"control flow that leads nowhere",
       [](Program& p) {
         p.time_slots[0].program.body.push_back({.kind = snippet_node::Kind::leave, .body = {}, .other = {}});
       }},
      {"a type or an array that there is not",
       [](Program& p) {
         p.time_slots[0].program.arrays.push_back({compiler::snippet::Type::real, 1u << 31});
       }},
      {"goes on after its end",
       [](Program& p) {
         auto* inner = &p.time_slots[0].program.body;
         for (int i = 0; i < 300; ++i) {
           inner->push_back({.kind = snippet_node::Kind::block, .body = {}, .other = {}});
           inner = &inner->back().body;
         }
       }},
  };
  for (const auto& one : cases) {
    const std::string& expected = one.first;
    const std::string message = refusal_of(program, one.second);
    CAPTURE(expected);
    CAPTURE(message);
    CHECK(message.find(expected) != std::string::npos);
  }
}

TEST_CASE("every scene buffer has a number and a name of its own, beside the two atlases") {
  std::set<std::uint32_t> numbers{0, 1};
  std::set<std::string_view> names;
  for (const compiler::SceneBuffer& row : compiler::scene_buffers()) {
    CHECK(numbers.insert(row.binding).second);
    CHECK(names.insert(row.name).second);
    CHECK(compiler::find_scene_buffer(row.binding) == &row);
    if (row.as_texels != compiler::BufferForm::records)
      CHECK(row.element_bytes % compiler::bytes_per_texel(row.as_texels) == 0);
  }
}
