// Bad input: one clear message, exit code 1, nothing left behind.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>

#include "runtime/view/picture.h"
#include "tests/cli/program.h"
#include "tests/cli/scenes.h"

using namespace dmvv::tests;

namespace {

bool holds(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

std::string scene_with(std::string_view inside_object) {
  return fmt::format("<MVV>\n<OBJECT name=\"A\">\n{}\n</OBJECT>\n</MVV>\n", inside_object);
}

std::string scene_with_sdf(std::string_view sdf_attributes) {
  return scene_with(
      fmt::format("<SDF name=\"S\" {}/>\n<REGION name=\"R\" type=\"color\" rgb=\"1 0 0\"/>", sdf_attributes));
}

std::string scene_with_bitmap(std::string_view file) {
  return scene_with(fmt::format("<REGION name=\"R\" type=\"bitmap\" file=\"{}\"/>", file));
}

/// The 128 bytes of an LXN header with these sizes, followed by one value.
std::string lying_lxn(std::int32_t x, std::int32_t y, std::int32_t z) {
  std::string bytes = sampled(2, [](const glm::dvec3&) { return 1.0; }).substr(0, 132);
  const std::int32_t size[3] = {x, y, z};
  for (int axis = 0; axis < 3; ++axis) {
    for (int byte = 0; byte < 4; ++byte) {
      bytes[static_cast<std::size_t>(16 + 4 * axis + byte)] = static_cast<char>(size[axis] >> (8 * byte));
    }
  }
  return bytes;
}

/// A plain picture as PNG.
std::string png(std::uint32_t width, std::uint32_t height) {
  const Folder folder;
  dmvv::runtime::Picture picture;
  picture.size_px = {width, height};
  picture.rgba.assign(std::size_t{4} * width * height, 0.5f);
  REQUIRE(dmvv::runtime::write_picture(folder.file("p.png"), picture));
  return folder.read("p.png");
}

}  // namespace

TEST_CASE("faulty scenes: exit code 1, the place and the cause, no picture") {
  struct Case {
    std::string name;
    std::string scene;
    std::vector<std::string> said;
  };
  const Folder folder;
  std::filesystem::create_directory(folder.file("folder"));
  const std::string fine_lxn = sampled(4, [](const glm::dvec3& q) { return q.x; });
  folder.write("fine.lxn", fine_lxn);
  folder.write("truncated.lxn", std::string_view(fine_lxn).substr(0, fine_lxn.size() - 5));
  folder.write("stub.lxn", "LXN");
  folder.write("overflow.lxn", lying_lxn(2147483647, 2147483647, 2147483647));
  folder.write("huge.lxn", lying_lxn(60000, 60000, 60000));
  folder.write("negative.lxn", lying_lxn(-1, 4, 4));
  folder.write("wrong.png", png(4, 15));
  folder.write("noise.png", "this is no picture");
  folder.write("seeds.txt", "0 0 0\n0.1 0 0\n");
  folder.write("short.txt", "1 1 1\n");
  folder.write("words.txt", "0 0 0\nzero 0 0\n");

  const std::vector<Case> cases{
      {"malformed XML", "<MVV>\n<OBJECT name=\"A\">\n</MVV>\n", {"scene.voml:", "error[E"}},
      {"no XML", "hello", {"scene.voml:1:1"}},
      {"missing attribute", scene_with("<REGION name=\"R\"/>"), {"scene.voml:3:", "type"}},
      {"unknown name",
       scene_with("<REGION name=\"R.INNER\" type=\"color\" rgb=\"1 0 0\"/><SDF name=\"S\" file=\"fine.lxn\"/>"
                  "<MAPPINGS><SDF name=\"S\"><NEGATIVE><REGION name=\"R.INTER\"/></NEGATIVE></SDF></MAPPINGS>"),
       {"scene.voml:3:", "R.INTER", "did you mean 'R.INNER'"}},
      {"cycle",
       "<MVV><OBJECT name=\"A\"><REGION name=\"R\" type=\"color\" rgb=\"1 0 0\"><EMBEDDED "
       "name=\"B\"/></REGION></OBJECT>"
       "<OBJECT name=\"B\"><REGION name=\"Q\" type=\"color\" rgb=\"1 0 0\"><EMBEDDED "
       "name=\"A\"/></REGION></OBJECT></MVV>",
       {"E0110", "A", "B"}},
      {"not finite", scene_with_sdf("file=\"fine.lxn\" translate=\"0 nan 0\""), {"scene.voml:3:", "translate"}},
      {"zero scale", scene_with_sdf("file=\"fine.lxn\" scale=\"1 0 1\""), {"scene.voml:3:", "scale"}},
      {"missing grid", scene_with_sdf("file=\"nowhere.lxn\""), {"scene.voml:3:", "nowhere.lxn"}},
      {"directory for grid", scene_with_sdf("file=\"folder\""), {"scene.voml:3:", "folder", "directory"}},
      {"truncated grid", scene_with_sdf("file=\"truncated.lxn\""), {"truncated.lxn", "256", "251"}},
      {"stub of a grid", scene_with_sdf("file=\"stub.lxn\""), {"stub.lxn"}},
      {"overflowing sizes", scene_with_sdf("file=\"overflow.lxn\""), {"overflow.lxn", "2147483647"}},
      {"sizes beyond memory", scene_with_sdf("file=\"huge.lxn\""), {"huge.lxn", "60000"}},
      {"negative size", scene_with_sdf("file=\"negative.lxn\""), {"negative.lxn", "-1"}},
      {"bitmap of the wrong size", scene_with_bitmap("wrong.png"), {"wrong.png", "4", "15"}},
      {"bitmap that is none", scene_with_bitmap("noise.png"), {"noise.png"}},
      {"missing bitmap", scene_with_bitmap("nowhere.png"), {"nowhere.png"}},
      {"seed files of different lengths",
       scene_with_sdf("file=\"fine.lxn\" type=\"seeding\" seedFile=\"seeds.txt\" scaleFile=\"short.txt\""),
       {"short.txt", "2", "1"}},
      {"seed file with words",
       scene_with_sdf("file=\"fine.lxn\" type=\"seeding\" seedFile=\"words.txt\""),
       {"words.txt:2:1"}},
  };
  for (const Case& one : cases) {
    CAPTURE(one.name);
    const std::string scene = folder.write("scene.voml", one.scene);
    const auto before = folder.listing();
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"check", scene},
                                                      {"render", scene, "-o", folder.file("p.png")},
                                                      {"compile", scene, "-o", folder.file("dump")},
                                                      {"probe", scene, "--point", "0 0 0"},
                                                      {"info", scene}}) {
      CAPTURE(arguments[0]);
      const Run run = run_dmvv(arguments);
      CAPTURE(run.err);
      CHECK(run.exit_code == 1);
      CHECK(run.out.empty());
      for (const std::string& part : one.said) CHECK_MESSAGE(holds(run.err, part), part);
    }
    CHECK(folder.listing() == before);
  }
}

TEST_CASE("a mistake in a snippet is reported at its place by every command") {
  const Folder folder;
  const std::string scene =
      folder.write("scene.voml",
                   "<MVV><OBJECT name=\"A\">\n<SDF name=\"S\" function=\"true\">\n  return lenght(p) - 0.5;</SDF>\n"
                   "<REGION name=\"R\" type=\"color\" rgb=\"1 0 0\"/></OBJECT></MVV>");
  const auto before = folder.listing();
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"check", scene},
                                                    {"render", scene, "-o", folder.file("p.png")},
                                                    {"compile", scene, "-o", folder.file("dump")},
                                                    {"probe", scene, "--point", "0 0 0"},
                                                    {"probe", scene, "--point", "0 0 0", "--backend", "vulkan"}}) {
    const Run run = run_dmvv(arguments);
    CHECK(run.exit_code == 1);
    CHECK(run.out.empty());
    CHECK_MESSAGE(holds(run.err, "scene.voml:3:10: error[E0402]"), run.err);
    CHECK_MESSAGE(holds(run.err, "did you mean 'length'?"), run.err);
  }
  CHECK(folder.listing() == before);
}

TEST_CASE("faulty files and folders: exit code 1, nothing left behind") {
  struct Case {
    std::vector<std::string> arguments;
    std::vector<std::string> said;
  };
  const Folder folder;
  const std::string scene = folder.write("scene.voml", nested_cubes);
  const std::string none = folder.file("none/x");
  const std::string directory = folder.file("folder.png");
  std::filesystem::create_directory(directory);
  const std::string text = folder.write("text.txt", "no folder");
  const std::string obj = folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  const std::string stl = folder.write("bad.stl", std::string(80, ' ') + std::string("\xff\xff\xff\x00", 4) + "short");
  const std::string flat = folder.write("empty.obj", "v 0 0 0\n");
  const std::string points = folder.write("points.txt", "0 0 0\n# fine so far\n0 0\n");
  // A thread of 40,000 samples fits no 3D texture of any device in reach.
  const std::string thread = [&] {
    dmvv::voml::Grid grid;
    grid.size = {40000, 1, 1};
    grid.values.assign(40000, -1.0f);
    folder.write("thread.lxn", dmvv::voml::write_lxn(grid));
    return folder.write("thread.voml", scene_with_sdf("file=\"thread.lxn\""));
  }();
  const std::string picture = folder.file("p.png");
  const auto before = folder.listing();

  const std::vector<Case> cases{
      {{"check", folder.file("missing.voml")}, {"missing.voml"}},
      {{"check", directory}, {"folder.png", "directory"}},
      {{"check", scene, "--root", "SHEL"}, {"SHEL"}},
      {{"render", folder.file("missing.voml"), "-o", picture}, {"missing.voml"}},
      {{"render", scene, "-o", none + ".png"}, {"none", "does not exist"}},
      {{"render", scene, "-o", text + "/p.png"}, {"text.txt", "not a folder"}},
      {{"render", scene, "-o", directory}, {"folder.png", "directory"}},
      {{"render", scene, "-o", folder.file("p.gif")}, {"p.gif", ".png", ".exr"}},
      {{"render", scene, "-o", picture, "--aov", "region=" + none + ".exr"}, {"none", "does not exist"}},
      {{"render", scene, "-o", picture, "--aov", "depth=" + folder.file("d.png")}, {"d.png", ".exr"}},
      {{"render", scene, "-o", picture, "--aov", "region=" + picture}, {"p.png", "two outputs"}},
      {{"render", scene, "-o", picture, "--mesh", folder.file("none.obj")}, {"none.obj"}},
      {{"render", scene, "-o", picture, "--mesh", obj}, {"bad.obj:4:"}},
      {{"render", scene, "-o", picture, "--mesh", stl}, {"bad.stl"}},
      {{"render", scene, "-o", picture, "--mesh", scene}, {"scene.voml"}},
      {{"render", thread, "-o", picture}, {"E0303", "thread.lxn"}},
      {{"compile", thread, "-o", folder.file("dump")}, {"E0303", "thread.lxn"}},
      {{"compile", scene, "-o", none}, {"none", "does not exist"}},
      {{"compile", scene, "-o", text}, {"text.txt", "not a folder"}},
      {{"probe", scene, "--points", folder.file("none.txt")}, {"none.txt"}},
      {{"probe", scene, "--points", points}, {"points.txt:3:"}},
      {{"info", folder.file("none.lxn")}, {"none.lxn"}},
      {{"info", text}, {"text.txt"}},
      {{"sdf", obj, "-o", folder.file("x.lxn")}, {"bad.obj:4:"}},
      {{"sdf", flat, "-o", folder.file("x.lxn")}, {"empty.obj"}},
      {{"sdf", obj, "-o", none + ".lxn"}, {"none", "does not exist"}},
      {{"sdf", obj, "-o", folder.file("x.sdf")}, {"x.sdf", ".lxn"}},
  };
  for (const Case& one : cases) {
    std::string line;
    for (const std::string& argument : one.arguments) line += argument + ' ';
    CAPTURE(line);
    const Run run = run_dmvv(one.arguments);
    CAPTURE(run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.out.empty());
    for (const std::string& part : one.said) CHECK_MESSAGE(holds(run.err, part), part);
    CHECK(folder.listing() == before);
  }
}

TEST_CASE("check goes through all scenes, and strict makes warnings errors") {
  const Folder folder;
  const std::string fine = folder.write("fine.voml", nested_cubes);
  const std::string broken = folder.write("broken.voml", "<MVV>");
  const std::string odd = folder.write("odd.voml",
                                       "<MVV><OBJECT name=\"A\" taste=\"sweet\">"
                                       "<REGION name=\"R\" type=\"empty\"/></OBJECT></MVV>");

  const Run both = run_dmvv({"check", broken, fine});
  CHECK(both.exit_code == 1);
  CHECK(holds(both.out, "fine.voml: fine: 2 objects, 0 SDFs, 2 regions\n"));
  CHECK(holds(both.err, "broken.voml:"));

  const Run warned = run_dmvv({"check", odd});
  CHECK(warned.exit_code == 0);
  CHECK(holds(warned.out, "1 warning"));
  CHECK(holds(warned.err, "taste"));
  CHECK(run_dmvv({"check", "--quiet", odd}).err.empty());

  const Run strict = run_dmvv({"check", "--strict", odd});
  CHECK(strict.exit_code == 1);
  CHECK(strict.out.empty());
}
