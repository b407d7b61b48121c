// Input made to hurt: it is refused or read, in bounded time and stack, and never crashes.
#include <fmt/format.h>

#include <random>

#include "tests/unit/voml/reading.h"

using namespace dmvv;
using namespace dmvv::voml;

namespace {

std::string chain_of_objects(std::size_t count, bool closed) {
  std::string text = "<MVV>";
  for (std::size_t i = 0; i < count; ++i) {
    const bool last = i + 1 == count;
    text += fmt::format("<OBJECT name='O{}'><REGION name='R' type='empty'>", i);
    if (!last || closed) text += fmt::format("<EMBEDDED name='O{}'/>", last ? 0 : i + 1);
    text += "</REGION></OBJECT>";
  }
  return text + "</MVV>";
}

}  // namespace

TEST_CASE("a chain of 10^5 embeddings is read without recursion") {
  const auto open = tests::read_text(chain_of_objects(100000, false), {}, {.root = "O0"});
  CHECK(open.messages == "");
  const auto closed = tests::read_text(chain_of_objects(100000, true));
  CHECK(closed.errors == 1);
  CHECK(closed.messages.find("error[E0110]: the object 'O0' embeds itself: O0 -> O1 -> ") != std::string::npos);
  CHECK(closed.messages.find("-> O99999 -> O0\n") != std::string::npos);
  CHECK(closed.messages.size() < 4000);
}

TEST_CASE("a tree as deep as elements may be nested is read without recursion") {
  constexpr std::size_t depth = 2040;  // two elements a level, within the 4096
  std::string tree = "<REGION name='R'/>";
  std::string before, after;
  for (std::size_t i = 0; i < depth; ++i) {
    before += "<SDF name='S'><POSITIVE region='R'/><NEGATIVE>";
    after += "</NEGATIVE></SDF>";
  }
  const Scene scene = tests::scene_of(
      "<MVV><OBJECT name='A'><SDF name='S' file='plane.lxn'/><REGION name='R' type='empty'/>"
      "<MAPPINGS>" +
      before + tree + after + "</MAPPINGS></OBJECT></MVV>");
  CHECK(scene.nodes.size() == 2 * depth + 1);
}

TEST_CASE("a chain of imports is read without recursion, up to a limit") {
  const auto chain = [](std::size_t count) {
    std::map<std::string, std::string> files;
    for (std::size_t i = 0; i < count; ++i) {
      files[i == 0 ? "scene.voml" : fmt::format("{}.voml", i)] =
          i + 1 == count ? "<MVV><OBJECT name='A'><REGION name='R' type='empty'/></OBJECT></MVV>"
                         : fmt::format("<MVV><IMPORT file='{}.voml'/></MVV>", i + 1);
    }
    return files;
  };
  CHECK(tests::read(chain(3000)).messages == "");
  const auto refused = tests::read(chain(4098));
  CHECK(refused.errors == 1);
  CHECK(refused.messages.find("4095.voml:1:20: error[E0005]: the scene has more than 4096 files up to here") !=
        std::string::npos);
}

TEST_CASE("a hundred thousand faults cost no more than a hundred") {
  std::string text = "<MVV><OBJECT name='A'><REGION name='R' type='empty'>";
  for (int i = 0; i < 100000; ++i) text += fmt::format("<EMBEDDED name='LOST{}'/>", i);
  text += "</REGION></OBJECT>";
  for (int i = 0; i < 10000; ++i)
    text += fmt::format("<OBJECT name='LAST{}'><REGION name='R' type='empty'/></OBJECT>", i);
  const auto reading = tests::read_text(text + "</MVV>");
  CHECK(reading.errors == 100000);
  CHECK(reading.messages.ends_with("100000 errors; the first 100 are shown\n"));
}

TEST_CASE("seed files full of faults or of huge numbers") {
  const std::string scene =
      "<MVV><OBJECT name='B'><REGION name='R' type='empty'/></OBJECT>"
      "<OBJECT name='A'><REGION name='R' type='empty'><EMBEDDED name='B' seedFile='s.txt'/></REGION></OBJECT></MVV>";
  std::string lines;
  for (int i = 0; i < 100000; ++i) lines += "x\n";
  CHECK(tests::read_text(scene, {{"s.txt", lines}}).errors == 100);  // reading stops there
  CHECK(tests::read_text(scene, {{"s.txt", "1e400 0 0"}}).errors == 1);
  CHECK(tests::read_text(scene, {{"s.txt", "3e38 0 0"}}).errors == 1);  // 2 * 3e38 leaves float32
  CHECK(tests::read_text(scene, {{"s.txt", "1e38 0 0"}}).errors == 0);
  CHECK(tests::read_text(scene, {{"s.txt", std::string(1 << 20, '7')}}).errors == 1);
}

TEST_CASE("scenes with random damage never crash and never pass in silence with an unfinished scene") {
  const std::string whole =
      "<MVV><IMPORT file='i.voml'/><OBJECT name='B'><SDF name='S' function='true'><![CDATA[return p.x;]]></SDF>"
      "<REGION name='R' type='color' rgb='1 0 0'/></OBJECT><OBJECT name='A'><SDF name='S' file='plane.lxn' index='4 4 "
      "4'/>"
      "<REGION name='R' type='bitmap' file='b.png'><INDEX size='2 2 2'><EMBEDDED name='B' "
      "seedFile='s.txt'/></INDEX></REGION>"
      "<MAPPINGS name='A'><SDF name='S'><POSITIVE region='R'/><NEGATIVE><REGION name='Q' "
      "type='empty'/></NEGATIVE></SDF>"
      "</MAPPINGS></OBJECT></MVV>";
  const std::map<std::string, std::string> files = {
      {"plane.lxn", tests::lxn()},
      {"b.png", tests::picture(2, 4)},
      {"s.txt", "0 0 0"},
      {"i.voml", "<MVV><OBJECT name='C'><REGION name='R' type='empty'/></OBJECT></MVV>"}};
  REQUIRE(tests::read_text(whole, files).messages == "");
  std::mt19937 random(1);
  for (int round = 0; round < 3000; ++round) {
    std::string text = whole;
    for (unsigned edits = random() % 4 + 1; edits > 0; --edits) {
      const std::size_t from = random() % text.size();
      const std::size_t length = random() % 12;
      const std::string piece = whole.substr(random() % whole.size(), random() % 12);
      text.replace(from, length, random() % 3 == 0 ? std::string(1, static_cast<char>(random())) : piece);
      if (text.empty()) text.push_back('<');
    }
    const auto reading = tests::read_text(text, files);
    if (!reading.scene) continue;
    for (const Object& object : reading.scene->objects) REQUIRE(object.root.valid());
    for (const Node& node : reading.scene->nodes) {
      const auto* decision = std::get_if<Decision>(&node.content);
      if (decision == nullptr) {
        REQUIRE(std::get<Id<Region>>(node.content).valid());
      } else {
        REQUIRE((decision->sdf.valid() && decision->positive.valid() && decision->negative.valid()));
      }
    }
    for (const Region& region : reading.scene->regions) {
      for (const EmbeddingGroup& group : region.groups) {
        for (const Embedded& embedded : group.embedded) REQUIRE(embedded.object.valid());
      }
    }
  }
}
