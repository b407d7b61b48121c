// Help, version, and wrong usage.
#include <doctest/doctest.h>

#include "tests/cli/program.h"
#include "tests/cli/scenes.h"

using namespace dmvv::tests;

namespace {
bool holds(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }
}  // namespace

TEST_CASE("help and version go to the standard output") {
  const Run version = run_dmvv({"--version"});
  CHECK(version.exit_code == 0);
  CHECK(version.out.starts_with("dmvv 0."));

  const Run help = run_dmvv({"--help"});
  CHECK(help.exit_code == 0);
  CHECK(help.err.empty());
  for (const std::string command :
       {"new", "check", "fmt", "render", "animate", "probe", "compile", "info", "sdf", "bench"}) {
    CHECK(holds(help.out, "\n  " + command));
    const Run details = run_dmvv({command, "--help"});
    CHECK(details.exit_code == 0);
    CHECK(holds(details.out, "Example"));
    CHECK(holds(details.out, "dmvv " + command));
  }
  for (const std::string later : {"view"}) CHECK(!holds(help.out, "\n  " + later));
}

TEST_CASE("wrong usage: exit code 2, one message, nothing on the standard output") {
  const Folder folder;
  const std::string scene = folder.write("scene.voml", nested_cubes);
  const std::string picture = folder.file("picture.png");
  const auto before = folder.listing();

  struct Case {
    std::vector<std::string> arguments;
    std::vector<std::string> said;  ///< on stderr
  };
  const std::vector<std::string> render{"render", scene, "-o", picture};
  const auto with = [](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const std::vector<Case> cases{
      {{}, {"no command"}},
      {{"view", scene}, {"unknown command 'view'"}},
      {{"render", scene}, {"--output"}},
      {{"render", "-o", picture}, {"SCENE"}},
      {with(render, {"--sise", "10x10"}), {"--sise"}},
      {with(render, {"--size", "10"}), {"--size", "10"}},
      {with(render, {"--size", "0x10"}), {"--size"}},
      {with(render, {"--camera", "eye 1 2 look 0 0 0"}), {"--camera"}},
      {with(render, {"--camera", "look 0 0 0"}), {"--camera", "eye"}},
      {with(render, {"--cut", "0 0 0 1"}), {"--cut"}},
      {with(render, {"--cut", "1 0 0"}), {"--cut"}},
      {with(render, {"--cut", "0", "0", "1", "0"}), {"not expected", "stand in quotes"}},
      {{"probe", scene, "--point", "0", "0.5", "-1e-3"}, {"not expected", "stand in quotes"}},
      {with(render, {"--slice", "w=1"}), {"--slice"}},
      {with(render, {"--slice", "z=0", "--cut", "1 0 0 0"}), {"--slice", "--cut"}},
      {with(render, {"--shading", "phong"}), {"--shading", "phong", "none", "lit"}},
      {with(render, {"--samples", "0"}), {"--samples"}},
      {with(render, {"--time", "nan"}), {"--time", "nan"}},
      {with(render, {"--time", "soon"}), {"--time", "soon"}},
      {with(render, {"--aov", "colour=x.exr"}), {"--aov", "colour=x.exr", "region=FILE"}},
      {with(render, {"--codegen", "fast"}), {"fast", "specialised", "table", "thesis"}},
      {with(render, {"--codegen", "thesis", "--atlas", "r16f"}), {"thesis", "--atlas"}},
      {with(render, {"--codegen", "thesis", "--disable", "index"}), {"thesis", "--disable"}},
      {with(render, {"--atlas", "r8"}), {"r8", "r32f", "r16f", "snorm16", "snorm8"}},
      {with(render, {"--filter", "cubic"}), {"cubic", "hardware", "shader", "tricubic"}},
      {with(render, {"--disable", "nothing"}), {"nothing", "passes that can be switched off"}},
      {with(render, {"--device", "no such device"}), {"no such device"}},
      {{"compile", scene, "-o", folder.file("dump"), "--dump", "glsl,ink"},
       {"ink", "glsl", "spirv", "records", "atlas"}},
      {{"probe", scene}, {"--points"}},
      {{"probe", scene, "--point", "0 0"}, {"--point"}},
      {{"probe", scene, "--point", "0 0 0", "--backend", "paper"}, {"paper", "reference", "vulkan"}},
      {{"sdf", scene, "-o", folder.file("x.lxn"), "--resolution", "3"}, {"--resolution"}},
  };
  for (const Case& one : cases) {
    std::string line;
    for (const std::string& argument : one.arguments) line += argument + ' ';
    CAPTURE(line);
    const Run run = run_dmvv(one.arguments);
    CAPTURE(run.err);
    CHECK(run.exit_code == 2);
    CHECK(run.out.empty());
    for (const std::string& part : one.said) CHECK_MESSAGE(holds(run.err, part), part);
  }
  CHECK(folder.listing() == before);
}

TEST_CASE("an unknown device: the message lists those there are") {
  const Folder folder;
  const std::string scene = folder.write("scene.voml", nested_cubes);
  const Run run = run_dmvv({"probe", scene, "--backend", "vulkan", "--point", "0 0 0", "--device", "abacus"});
  CHECK(run.exit_code == 2);
  CHECK(holds(run.err, "abacus"));
  const Run fine = run_dmvv({"render", scene, "-o", folder.file("p.png"), "--size", "8x8"});
  REQUIRE(fine.exit_code == 0);
  // "...: 8x8, 0.31 s on NAME" names the device that the list must hold.
  const std::size_t on = fine.out.find(" s on ");
  REQUIRE(on != std::string::npos);
  const std::string device = fine.out.substr(on + 6, fine.out.size() - on - 7);
  CHECK_MESSAGE(holds(run.err, device), run.err);
}
