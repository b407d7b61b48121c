// Which files are opened, and how often.
#include "tests/unit/voml/reading.h"

using namespace dmvv;
using namespace dmvv::voml;

namespace {

const std::string scene_text = R"(<MVV>
  <OBJECT name="UNUSED"><SDF name="S" file="unused.lxn"/><REGION name="R" type="bitmap" file="unused.png"/></OBJECT>
  <OBJECT name="PART"><SDF name="S" file="./both.lxn"/><REGION name="R" type="empty"/></OBJECT>
  <OBJECT name="A">
    <SDF name="S" file="both.lxn"/>
    <SDF name="T" file="idle.lxn" type="seeding" seedFile="idle.txt"/>
    <REGION name="R" type="bitmap" file="b.png">
      <EMBEDDED name="PART" seedFile="s.txt"/><EMBEDDED name="PART" seedFile="s.txt" rotateFile="s.txt"/>
    </REGION>
    <REGION name="Q" type="bitmap" file="idle.png"><EMBEDDED name="UNUSED" seedFile="idle.txt"/></REGION>
    <MAPPINGS><SDF name="S"><POSITIVE region="R"/><NEGATIVE region="R"/></SDF></MAPPINGS>
  </OBJECT>
</MVV>)";

const std::map<std::string, std::string> needed_files = {
    {"both.lxn", tests::lxn()}, {"b.png", tests::picture(2, 4)}, {"s.txt", "0 0 0\n"}};

}  // namespace

TEST_CASE("only what the root can reach is opened, each file once") {
  const auto reading = tests::read_text(scene_text, needed_files);
  CHECK(reading.messages == "");
  CHECK(reading.opened == std::map<std::string, int>{{"scene.voml", 1}, {"both.lxn", 1}, {"b.png", 1}, {"s.txt", 1}});
  REQUIRE(reading.scene);
  REQUIRE(reading.scene->grids.size() == 3);  // unused, both, idle; the one named twice is one
  CHECK(reading.scene->grids[0].path == "unused.lxn");
  CHECK(reading.scene->grids[0].values.empty());
  CHECK(reading.scene->grids[1].path == "both.lxn");
  CHECK(reading.scene->grids[1].values.size() == 8);
}

TEST_CASE("load_everything opens the rest as well") {
  const auto reading = tests::read_text(scene_text, needed_files, {.root = "", .load_everything = true});
  CHECK(reading.errors == 5);  // unused.lxn, unused.png, idle.lxn, idle.txt, idle.png
  for (const char* name : {"unused.lxn", "unused.png", "idle.lxn", "idle.txt", "idle.png"}) {
    CAPTURE(name);
    CHECK(reading.messages.find("cannot read '" + std::string(name) + "': no such file") != std::string::npos);
    CHECK(reading.opened.at(name) == 1);
  }
}
