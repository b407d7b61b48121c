#include "compiler/plan/stage_plan.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <set>

#include "compiler/glsl/families.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using compiler::StageOptions;
using compiler::Way;

namespace {

constexpr StageOptions everything{.least_program_lines = 0, .least_lines = 1};

/// ROOT lists some CELLs, behind them it holds BODY; of its regions CORE and SHELL list CELLs, BARE holds nothing.
const char* const body_text = R"(<MVV>
  <OBJECT name="CELL"><SDF name="S" function="true">return length(p) - 0.7;</SDF>
    <REGION name="IN" type="color" rgb="1 0.2 0"/><REGION name="AIR" type="empty"/>
    <MAPPINGS><SDF name="S"><POSITIVE region="AIR"/><NEGATIVE region="IN"/></SDF></MAPPINGS></OBJECT>
  <OBJECT name="BODY"><SDF name="A" function="true">return length(p) - 0.9;</SDF><SDF name="B" function="true">return length(p) - 0.5;</SDF>
    <REGION name="BARE" type="color" rgb="1 1 1"/>
    <REGION name="SHELL" type="color" rgb="0 0 1"><EMBEDDED name="CELL" type="seeding" seedFile="seeds.txt" scale="0.2 0.2 0.2"/></REGION>
    <REGION name="CORE" type="color" rgb="0 1 0"><EMBEDDED name="CELL" type="seeding" seedFile="seeds.txt" scale="0.3 0.3 0.3"/></REGION>
    <MAPPINGS><SDF name="A"><POSITIVE region="BARE"/><NEGATIVE><SDF name="B"><POSITIVE region="SHELL"/><NEGATIVE region="CORE"/></SDF></NEGATIVE>
    </SDF></MAPPINGS></OBJECT>
  <OBJECT name="ROOT"><REGION name="ALL" type="empty">
      <INDEX size="4 4 4"><EMBEDDED name="CELL" type="seeding" seedFile="seeds.txt" scale="0.1 0.1 0.1"/></INDEX>
      <EMBEDDED name="BODY"/></REGION>
    <MAPPINGS><REGION name="ALL"/></MAPPINGS></OBJECT></MVV>)";

compiler::Module body() {
  return tests::lowered(body_text, {{"seeds.txt", "0.3 0.2 0\n0.2 -0.3 0.1\n0.4 0 0.4\n-0.1 0.1 0.2\n"}});
}

compiler::CodePlan plan(const compiler::Module& module) {
  compiler::SourceSizes sizes;
  sizes.function_lines.assign(module.functions.size(), 3);
  std::vector<Id<compiler::Object>> alike;
  for (std::uint32_t i = 0; i < module.objects.size(); ++i) alike.push_back({i});
  return compiler::plan_code(module, sizes, alike, {compiler::Codegen::specialised, 4000, {}});
}

std::string names(const compiler::Module& module, const Way& way) {
  std::string text;
  for (const auto region : way) text += (text.empty() ? "" : "/") + at(module.regions, region).name;
  return text;
}

}  // namespace

TEST_CASE("a stage begins before a list of the root's one region, and with each region that lists something") {
  const auto module = body();
  const compiler::StagePlan stages = compiler::plan_stages(module, plan(module), everything);
  std::set<std::string> begins;
  for (const auto& [begin, number] : stages.numbers)
    begins.insert(fmt::format("{} {}", names(module, begin.first), begin.second));
  CHECK(begins == std::set<std::string>{"ALL 0", "ALL/SHELL 0", "ALL/CORE 0"});
}

TEST_CASE("stages are numbered from 1, a way's own before those further down it") {
  const auto module = body();
  const compiler::StagePlan stages = compiler::plan_stages(module, plan(module), everything);
  std::set<std::uint32_t> numbers;
  for (const auto& [begin, number] : stages.numbers) {
    numbers.insert(number);
    for (const auto& [other, other_number] : stages.numbers) {
      const Way& way = begin.first;
      const bool is_below = other.first.size() > way.size() && std::equal(way.begin(), way.end(), other.first.begin());
      if (is_below) CHECK(number < other_number);
    }
  }
  CHECK(numbers == std::set<std::uint32_t>{1, 2, 3});
}

TEST_CASE("small programs, small lists and what is walked are not divided") {
  const auto module = body();
  const compiler::CodePlan code = plan(module);
  CHECK(compiler::plan_stages(module, code, {.least_program_lines = code.inlined_lines + 1, .least_lines = 1})
            .numbers.empty());
  CHECK_FALSE(compiler::plan_stages(module, code, {.least_program_lines = code.inlined_lines, .least_lines = 1})
                  .numbers.empty());
  CHECK(compiler::plan_stages(module, code, {.least_program_lines = 0, .least_lines = code.inlined_lines})
            .numbers.empty());
  compiler::CodePlan walked = code;
  walked.cut.assign(walked.cut.size(), true);
  CHECK(compiler::plan_stages(module, walked, everything).numbers.empty());
}

TEST_CASE("of more regions than there can be stages, those of most code have one") {
  std::string regions, mappings, closing;
  for (int i = 0; i < 24; ++i) {
    const std::string cell = i < 8 ? "LARGE" : "SMALL";
    regions += fmt::format(
        "<SDF name='S{0}' function='true'>return p.x - {1};</SDF><REGION name='R{0}' type='empty'><EMBEDDED name='{2}' "
        "type='seeding' seedFile='seeds.txt' scale='0.2 0.2 0.2'/></REGION>",
        i, 0.9 - 0.07 * i, cell);
    mappings += fmt::format("<SDF name='S{0}'><POSITIVE region='R{0}'/><NEGATIVE>", i);
    closing += "</NEGATIVE></SDF>";
  }
  const auto cell = [](const char* name, int decisions) {
    std::string text = fmt::format("<OBJECT name='{}'>", name), tree, end;
    for (int i = 0; i < decisions; ++i) {
      text += fmt::format(
          "<SDF name='S{0}' function='true'>return length(p) - {1};</SDF><REGION name='R{0}' type='color' rgb='1 0 "
          "0'/>",
          i, 0.9 - 0.1 * i);
      tree += fmt::format("<SDF name='S{0}'><POSITIVE region='R{0}'/><NEGATIVE>", i);
      end += "</NEGATIVE></SDF>";
    }
    return text + "<REGION name='LAST' type='empty'/><MAPPINGS>" + tree + "<REGION name='LAST'/>" + end +
           "</MAPPINGS></OBJECT>";
  };
  const auto module = tests::lowered("<MVV>" + cell("LARGE", 7) + cell("SMALL", 2) + "<OBJECT name='ROOT'>" + regions +
                                         "<REGION name='REST' type='empty'/><MAPPINGS>" + mappings +
                                         "<REGION name='REST'/>" + closing + "</MAPPINGS></OBJECT></MVV>",
                                     {{"seeds.txt", "0.3 0.2 0\n-0.3 0.1 0\n"}});
  const compiler::StagePlan stages = compiler::plan_stages(module, plan(module), everything);
  std::set<std::string> begins;
  for (const auto& [begin, number] : stages.numbers) begins.insert(names(module, begin.first));
  CHECK(begins == std::set<std::string>{"R0", "R1", "R2", "R3", "R4", "R5", "R6", "R7"});
}

TEST_CASE("each stage holds only its own code, and pixels go on to later ones") {
  const auto module = body();
  compiler::CompileOptions options;
  options.many_frames = true;
  options.stages = everything;
  options.disabled_passes = {"unite-shapes"};
  const auto program = tests::compiled(module, options);
  const std::vector<compiler::Shader>& stages = program.find_kernel("pixels")->shaders;
  REQUIRE(stages.size() == 4);
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const std::string& glsl = stages[i].glsl;
    CAPTURE(glsl);
    bool goes_on = false;
    for (std::size_t other = 1; other < stages.size(); ++other) {
      const bool named = glsl.find(fmt::format("next_stage = {}u", other)) != std::string::npos;
      if (named) CHECK(other > i);
      goes_on = goes_on || named;
    }
    CHECK(stages[i].has_next == goes_on);
    CHECK_FALSE(stages[i].spirv.empty());
    CHECK((glsl.find("// CELL\nbool object_") != std::string::npos) == (i != 0));  // the first stage only searches
  }
  options.disabled_passes.emplace_back("stages");
  CHECK_FALSE(tests::compiled(module, options).find_kernel("pixels")->is_staged());
  options.disabled_passes.clear();
  options.many_frames = false;
  CHECK_FALSE(tests::compiled(module, options).find_kernel("pixels")->is_staged());
}

TEST_CASE("a text given out as a copy is given out again") {
  compiler::Families families;
  families.add("half", "float half(float x) {\n  return 0.5 * x;\n}\n");
  families.add("quarter", "float quarter(float x) {\n  return half(half(x));\n}\n");
  families.settle();
  const std::string copied = families.copy({"quarter"});
  CHECK(copied.find("float half(") != std::string::npos);
  CHECK(families.copy({"quarter"}) == copied);
  CHECK(families.take({"quarter"}) == copied);
  CHECK(families.copy({"quarter"}).empty());
}
