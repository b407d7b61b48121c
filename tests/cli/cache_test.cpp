// The cache of compiled code never changes an answer, whatever befalls it.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include "tests/cli/program.h"

using namespace dmvv::tests;
namespace fs = std::filesystem;

namespace {

/// While it lives, programs find their cache in a folder of the test's own; Mesa's shader cache moves there as well.
class CacheHome {
 public:
  explicit CacheHome(const std::string& path) {
    if (const char* const known = std::getenv("XDG_CACHE_HOME")) before_ = known;
    setenv("XDG_CACHE_HOME", path.c_str(), 1);
  }
  CacheHome(const CacheHome&) = delete;
  CacheHome& operator=(const CacheHome&) = delete;
  ~CacheHome() { before_ ? setenv("XDG_CACHE_HOME", before_->c_str(), 1) : unsetenv("XDG_CACHE_HOME"); }

 private:
  std::optional<std::string> before_;
};

constexpr const char* moving_scene = R"(<MVV>
  <OBJECT name="BALL">
    <SDF name="S" function="true">float r = 0.6 + 0.1 * sin(t / 300.0); return length(p) - r;</SDF>
    <SDF name="CORE" function="true">return length(p - vec3(0.1)) - 0.2;</SDF>
    <REGION name="R.OUT" type="empty"/>
    <REGION name="R.SKIN" type="color" rgb="0.8 0.3 0.1"/>
    <REGION name="R.CORE" type="color" rgb="0.1 0.3 0.8"/>
    <MAPPINGS name="BALL">
      <SDF name="S"><POSITIVE region="R.OUT"/><NEGATIVE>
        <SDF name="CORE"><POSITIVE region="R.SKIN"/><NEGATIVE region="R.CORE"/></SDF></NEGATIVE></SDF>
    </MAPPINGS>
  </OBJECT>
</MVV>
)";

std::vector<fs::path> files_below(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(folder, none)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  return files;
}

}  // namespace

TEST_CASE("a picture is the same without, with an empty, a full, a damaged and a vanished cache") {
  const Folder folder;
  const std::string home = folder.file("cache");
  const CacheHome scoped(home);
  const std::string scene = folder.write("scene.voml", moving_scene);
  const auto render = [&](std::vector<std::string> more = {}, const char* said = "") {
    std::vector<std::string> arguments{"render", scene,    "-o", folder.file("p.png"), "--slice", "z=0", "--size",
                                       "96x64",  "--time", "700"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Run run = run_dmvv(arguments);
    CHECK(run.exit_code == 0);
    CHECK(run.err.substr(0, std::string(said).size()) == said);
    CHECK(run.err.empty() == (*said == '\0'));
    return folder.read("p.png");
  };
  const std::string truth = render({"--no-cache"});
  CHECK(files_below(home).empty());

  CHECK(render() == truth);
  const auto ours = files_below(home + "/dmvv");
  CHECK(ours.size() == 6);  // two snippets, the kernel, its pipelines, those of the two that list pixels before it
  CHECK(files_below(home + "/mesa_shader_cache").size() >= 1);
  CHECK(render() == truth);
  CHECK(files_below(home + "/dmvv") == ours);  // nothing was compiled that was known

  for (const char* const damage : {"", "garbage", "all zero"}) {
    for (const fs::path& file : files_below(home)) {
      const auto size = fs::file_size(file);
      std::fstream(file, std::ios::binary | std::ios::in | std::ios::out)
          << (std::string(damage) == "all zero" ? std::string(size, '\0') : std::string(damage));
      if (*damage == '\0') fs::resize_file(file, size / 2);
    }
    CAPTURE(damage);
    CHECK(render() == truth);
    CHECK(render() == truth);
  }
  fs::remove_all(home);
  CHECK(render() == truth);
  fs::remove_all(home);
  folder.write("cache", "a file where the folder should be");
  CHECK(render({}, "Cannot use") == truth);  // so says Mesa; we say nothing
}

TEST_CASE("an edited snippet is compiled, the other ones are not") {
  const Folder folder;
  const std::string home = folder.file("cache");
  const CacheHome scoped(home);
  std::string text = moving_scene;
  const auto answer = [&] {
    const std::string scene = folder.write("scene.voml", text);
    return run_dmvv({"probe", scene, "--backend", "vulkan", "--point", "0.1 0.1 0.35"}).out;
  };
  CHECK(answer() == "0.1 0.1 0.35\tBALL:R.SKIN\t0.8 0.3 0.1\n");
  CHECK(files_below(home + "/dmvv").size() == 4);  // two snippets, the kernel, its pipelines
  text.replace(text.find("- 0.2;"), 5, "- 0.3");
  CHECK(answer() == "0.1 0.1 0.35\tBALL:R.CORE\t0.1 0.3 0.8\n");
  CHECK(files_below(home + "/dmvv").size() == 4 + 3);  // one snippet, the kernel, its pipelines
}
