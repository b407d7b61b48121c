// Every feature of VOML, read from text. The rules are those of spec/voml.md.
#include "tests/unit/voml/reading.h"

using namespace dmvv;
using namespace dmvv::voml;
using tests::read;
using tests::read_text;
using tests::scene_of;

namespace {

const Object& root(const Scene& scene) { return at(scene.objects, scene.root); }
const Node& tree(const Scene& scene) { return at(scene.nodes, root(scene).root); }
const Decision& decision(const Scene& scene, Id<Node> node) {
  return std::get<Decision>(at(scene.nodes, node).content);
}
const Region& region(const Scene& scene, Id<Node> node) {
  return at(scene.regions, std::get<Id<Region>>(at(scene.nodes, node).content));
}
const Sdf& first_sdf(const Scene& scene) { return at(scene.sdfs, std::get<Decision>(tree(scene).content).sdf); }

std::string object_with(const std::string& inside) { return "<MVV><OBJECT name='A'>" + inside + "</OBJECT></MVV>"; }

const std::string empty_region = "<REGION name='R' type='empty'/>";

}  // namespace

// ---- document ----

TEST_CASE("tags and attributes are matched without regard to case") {
  const Scene scene = scene_of(R"(<mvv><Object NAME="A">
      <Sdf Name="S" FILE="plane.lxn" Translate="1 2 3" TYPE="Tiling"/>
      <region name="R" type="COLOR" RGB="1 0 0"/><Region name="Q" type="Empty"/>
      <Mappings><sdf name="S"><Positive Region="Q"/><negative><Region Name="R"/></negative></sdf></Mappings>
    </Object></mvv>)");
  CHECK(first_sdf(scene).transform.translate == glm::dvec3(1, 2, 3));
  CHECK(first_sdf(scene).placement == Placement::tiled);
  CHECK(region(scene, decision(scene, root(scene).root).negative).rgb == glm::dvec3(1, 0, 0));
  CHECK(region(scene, decision(scene, root(scene).root).positive).kind == RegionKind::empty);
}

TEST_CASE("the root is the last object of the document, or the one asked for") {
  const std::string text = "<MVV><OBJECT name='A'>" + empty_region + "</OBJECT><OBJECT name='B'>" + empty_region +
                           "</OBJECT><IMPORT file='more.voml'/></MVV>";
  const std::map<std::string, std::string> files = {
      {"more.voml", "<MVV><OBJECT name='C'>" + empty_region + "</OBJECT></MVV>"}};
  CHECK(root(scene_of(text, files)).name == "B");  // what is imported is not the document's own
  const auto chosen = read_text(text, files, {.root = "A"});
  REQUIRE(chosen.scene);
  CHECK(root(*chosen.scene).name == "A");
  const auto imported = read_text(text, files, {.root = "C"});
  REQUIRE(imported.scene);
  CHECK(root(*imported.scene).name == "C");
  const auto only_imports = scene_of("<MVV><IMPORT file='more.voml'/></MVV>", files);
  CHECK(root(only_imports).name == "C");
}

TEST_CASE("objects may be embedded before they are defined") {
  const auto reading = read_text(
      "<MVV><OBJECT name='A'><REGION name='R' type='empty'><EMBEDDED name='B'/></REGION></OBJECT>"
      "<OBJECT name='B'>" +
          empty_region + "</OBJECT></MVV>",
      {}, {.root = "A"});
  CHECK(reading.messages == "");
  REQUIRE(reading.scene);
  CHECK(at(reading.scene->objects, reading.scene->regions[0].groups[0].embedded[0].object).name == "B");
}

TEST_CASE("imports are read where they stand, once, relative to the file that imports them") {
  const std::map<std::string, std::string> files = {
      {"dir/scene.voml",
       "<MVV><IMPORT file='lib/a.voml'/><OBJECT name='S'><REGION name='R' type='empty'>"
       "<EMBEDDED name='LEAF'/></REGION></OBJECT><IMPORT file='lib/../lib/leaf.voml'/></MVV>"},
      {"dir/lib/a.voml", "<MVV><IMPORT file='leaf.voml'/><OBJECT name='A'>" + empty_region + "</OBJECT></MVV>"},
      {"dir/lib/leaf.voml",
       "<MVV><OBJECT name='LEAF'><SDF name='S' file='leaf.lxn'/>" + empty_region + "</OBJECT></MVV>"},
      {"dir/lib/leaf.lxn", tests::lxn()}};
  const auto reading = read(files, {}, "dir/scene.voml");
  CHECK(reading.messages == "");
  REQUIRE(reading.scene);
  REQUIRE(reading.scene->objects.size() == 3);
  CHECK(reading.scene->objects[0].name == "LEAF");
  CHECK(reading.scene->objects[1].name == "A");
  CHECK(reading.scene->objects[2].name == "S");
  CHECK(reading.opened ==
        std::map<std::string, int>{
            {"dir/scene.voml", 1}, {"dir/lib/a.voml", 1}, {"dir/lib/leaf.voml", 1}, {"dir/lib/leaf.lxn", 1}});
}

TEST_CASE("a name is looked up in its own object first") {
  const Scene scene = scene_of(
      "<MVV><OBJECT name='A'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT>"
      "<OBJECT name='B'><REGION name='R' type='color' rgb='0 1 0'/><MAPPINGS><REGION "
      "name='R'/></MAPPINGS></OBJECT></MVV>");
  CHECK(region(scene, root(scene).root).rgb == glm::dvec3(0, 1, 0));
}

TEST_CASE("a name of the one other object that defines it is taken with a warning") {
  const auto reading = read_text(
      "<MVV><OBJECT name='A'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT>"
      "<OBJECT name='B'><MAPPINGS><REGION name='R'/></MAPPINGS></OBJECT></MVV>");
  CHECK(reading.warnings == 1);
  REQUIRE(reading.scene);
  CHECK(region(*reading.scene, root(*reading.scene).root).rgb == glm::dvec3(1, 0, 0));
}

TEST_CASE("definitions within a tree count like those beside it, also for what stands before them") {
  const Scene scene = scene_of(object_with(R"(<MAPPINGS name="A">
      <SDF name="S">
        <POSITIVE><SDF name="S" file="plane.lxn" offset="0.25">
          <POSITIVE region="R"/>
          <NEGATIVE><REGION name="Q" type="empty"/></NEGATIVE>
        </SDF></POSITIVE>
        <NEGATIVE><REGION name="R" type="color" rgb="0 0 1"/></NEGATIVE>
      </SDF></MAPPINGS>)"));
  REQUIRE(scene.sdfs.size() == 1);
  const Decision& outer = decision(scene, root(scene).root);
  const Decision& inner = decision(scene, outer.positive);
  CHECK(outer.sdf == inner.sdf);
  CHECK(scene.sdfs[0].offset == 0.25);
  CHECK(region(scene, inner.positive).name == "R");
  CHECK(region(scene, inner.negative).name == "Q");
  CHECK(region(scene, outer.negative).rgb == glm::dvec3(0, 0, 1));
}

TEST_CASE("NEGATIVE may stand before POSITIVE; a tree may be a lone region") {
  const Scene scene = scene_of(
      object_with("<SDF name='S' file='plane.lxn'/><REGION name='IN' type='empty'/><REGION name='OUT' type='empty'/>"
                  "<MAPPINGS><SDF name='S'><NEGATIVE region='IN'/><POSITIVE region='OUT'/></SDF></MAPPINGS>"));
  CHECK(region(scene, decision(scene, root(scene).root).negative).name == "IN");
  CHECK(region(scene, decision(scene, root(scene).root).positive).name == "OUT");
  const Scene lone = scene_of(object_with(empty_region + "<MAPPINGS><REGION name='R'/></MAPPINGS>"));
  CHECK(region(lone, root(lone).root).name == "R");
}

TEST_CASE("an object without MAPPINGS: its region inside, nothing outside") {
  const Scene scene =
      scene_of(object_with("<SDF name='S' file='plane.lxn'/><REGION name='R' type='color' rgb='1 1 1'/>"));
  const Decision& d = decision(scene, root(scene).root);
  CHECK(at(scene.sdfs, d.sdf).name == "S");
  CHECK(region(scene, d.negative).name == "R");
  CHECK(region(scene, d.positive).kind == RegionKind::empty);
  const Scene lone = scene_of(object_with(empty_region));
  CHECK(region(lone, root(lone).root).name == "R");
}

// ---- SDFs ----

TEST_CASE("attributes of an SDF") {
  const Scene scene =
      scene_of(object_with("<SDF name='S' file='plane.lxn' translate='1,2,3' rotate='10 20 30' scale='2 -3 4' "
                           "offset='-0.5' index='4 5 6'/>" +
                           empty_region));
  const Sdf& sdf = first_sdf(scene);
  CHECK(sdf.transform.translate == glm::dvec3(1, 2, 3));
  CHECK(sdf.transform.rotate_deg == glm::dvec3(10, 20, 30));
  CHECK(sdf.transform.scale == glm::dvec3(2, -3, 4));
  CHECK(sdf.offset == -0.5);
  CHECK(sdf.index_size == glm::uvec3(4, 5, 6));
  CHECK(sdf.placement == Placement::single);
  CHECK(at(scene.grids, std::get<Id<Grid>>(sdf.source)).values == tests::plane_grid().values);
}

TEST_CASE("a seeding SDF: seeds in file order, rotations and scales beside them or left out") {
  const Scene scene = scene_of(
      object_with("<SDF name='S' file='plane.lxn' type='seeding' seedFile='s.txt' scaleFile='c.txt'/>" + empty_region),
      {{"s.txt", "# three\n0 0 0\r\n\n0.5,-0.5,0.25 # corner\n1 2 3"}, {"c.txt", "1 1 1\n2 2 2\n3 3 3\n"}});
  CHECK(first_sdf(scene).placement == Placement::seeded);
  const auto& seeds = at(scene.seed_lists, first_sdf(scene).seeds).seeds;
  REQUIRE(seeds.size() == 3);
  CHECK(seeds[1].position == glm::dvec3(0.5, -0.5, 0.25));
  CHECK(seeds[2].position == glm::dvec3(1, 2, 3));
  CHECK(seeds[2].rotate_deg == glm::dvec3(0));
  CHECK(seeds[2].scale == glm::dvec3(3));
}

TEST_CASE("an analytic SDF: its text with entities resolved, line for line as in the file") {
  const std::string text =
      "<MVV><OBJECT name='A'><SDF name='S' function='true'>\nfloat r = p.x &lt; 0.0 ? 1.0 : 2.0;<!-- a\n comment -->\n"
      "<![CDATA[return p.y < r ? -1.0 : 1.0;]]></SDF>" +
      empty_region + "</OBJECT></MVV>";
  const Scene scene = scene_of(text);
  const Function& function = at(scene.functions, std::get<Id<Function>>(first_sdf(scene).source));
  CHECK(function.body.text == "\nfloat r = p.x < 0.0 ? 1.0 : 2.0;\n\nreturn p.y < r ? -1.0 : 1.0;");
  CHECK(text.substr(function.span.begin, 6) == "\nfloat");
  CHECK(text.substr(function.span.end, 3) == "]]>");
}

// ---- regions and embedding ----

TEST_CASE("regions: colour, bitmap, empty, opacity") {
  const Scene scene = scene_of(
      object_with("<REGION name='C' type='color' rgb='0.1 0.2 0.3' opacity='0.25'/>"
                  "<REGION name='B' type='bitmap' file='b.png' scale='0.2 0.2 0.2' rotate='1 2 3' translate='4 5 6'/>"
                  "<REGION name='E' type='empty'/><MAPPINGS><REGION name='B'/></MAPPINGS>"),
      {{"b.png", tests::picture(2, 4)}});
  REQUIRE(scene.regions.size() == 3);
  CHECK(scene.regions[0].rgb == glm::dvec3(0.1, 0.2, 0.3));
  CHECK(scene.regions[0].opacity == 0.25);
  CHECK(scene.regions[1].kind == RegionKind::bitmap);
  CHECK(scene.regions[1].opacity == 1.0);
  CHECK(scene.regions[1].transform.scale == glm::dvec3(0.2));
  CHECK(scene.regions[1].transform.rotate_deg == glm::dvec3(1, 2, 3));
  CHECK(scene.regions[1].transform.translate == glm::dvec3(4, 5, 6));
  CHECK(at(scene.bitmaps, scene.regions[1].bitmap).n == 2);
  CHECK(scene.regions[2].kind == RegionKind::empty);
}

TEST_CASE("embedded objects keep document order; each INDEX is a group, and each run between two") {
  const Scene scene = scene_of(
      "<MVV><OBJECT name='X'>" + empty_region +
          "</OBJECT><OBJECT name='A'><REGION name='R' type='empty'>"
          "<EMBEDDED name='X' translate='1 0 0'/><EMBEDDED name='X' type='tiling'/>"
          "<INDEX size='2 3 4' scale='0.5 0.5 0.5' translate='0 1 0'><EMBEDDED name='X' seedFile='s.txt' rotate='0 5 "
          "0'/></INDEX>"
          "<INDEX size='1 1 1'/><EMBEDDED name='X' rotateFile='s.txt' seedFile='s.txt'/></REGION></OBJECT></MVV>",
      {{"s.txt", "1 2 3"}});
  const auto& groups = region(scene, root(scene).root).groups;
  REQUIRE(groups.size() == 4);
  CHECK_FALSE(groups[0].index);
  REQUIRE(groups[0].embedded.size() == 2);
  CHECK(groups[0].embedded[0].transform.translate == glm::dvec3(1, 0, 0));
  CHECK(groups[0].embedded[0].placement == Placement::single);
  CHECK(groups[0].embedded[1].placement == Placement::tiled);
  REQUIRE(groups[1].index);
  CHECK(groups[1].index->size == glm::uvec3(2, 3, 4));
  CHECK(groups[1].index->transform.scale == glm::dvec3(0.5));
  CHECK(groups[1].index->transform.translate == glm::dvec3(0, 1, 0));
  REQUIRE(groups[1].embedded.size() == 1);
  CHECK(groups[1].embedded[0].placement == Placement::seeded);
  CHECK(groups[1].embedded[0].transform.rotate_deg == glm::dvec3(0, 5, 0));
  CHECK(groups[2].embedded.empty());
  CHECK_FALSE(groups[3].index);
  CHECK(at(scene.seed_lists, groups[3].embedded[0].seeds).seeds[0].rotate_deg == glm::dvec3(1, 2, 3));
}

// ---- faults ----

TEST_CASE("all faults of a scene are reported at once") {
  const auto reading = read_text(
      "<MVV><OBJECT name='A'>"
      "<SDF name='S' file='lost.lxn' scale='1 0 1'/><REGION name='R' type='colour' opacity='2'/>"
      "<MAPPINGS name='B'><SDF name='T'><POSITIVE region='Q'/></SDF></MAPPINGS></OBJECT></MVV>",
      {}, {.root = "", .load_everything = true});
  for (const char* code : {"E0001", "E0103", "E0105", "E0107", "E0206", "E0207", "E0208"}) {
    CAPTURE(code);
    CHECK(reading.messages.find(code) != std::string::npos);
  }
  CHECK(reading.errors == 8);  // E0103 twice
}

TEST_CASE("a broken definition is one fault: what refers to it is none") {
  const auto reading =
      read_text(object_with("<SDF name='S' file=''/><REGION name='R' type='what'/>"
                            "<MAPPINGS><SDF name='S'><POSITIVE region='R'/><NEGATIVE region='R'/></SDF></MAPPINGS>"));
  CHECK(reading.errors == 2);
  CHECK(reading.warnings == 0);
}

TEST_CASE("one mistake gives one message") {
  const std::string plane = "<SDF name='S' file='plane.lxn'/>";
  const std::string colour = "<REGION name='R' type='color' rgb='1 0 0'/>";
  const auto tree = [](const std::string& positive) {
    return "<MAPPINGS><SDF name='S'>" + positive + "<NEGATIVE region='R'/></SDF></MAPPINGS>";
  };
  const std::string embed = "<REGION name='R' type='empty'><EMBEDDED name='A.B' /></REGION>";
  const std::string texts[] = {
      object_with(plane + colour + tree("<POSITIVE regoin='R'/>")),
      object_with(plane + colour + tree("<POSITVE region='R'/>")),
      object_with(plane + colour + tree("<POSITIVE><REGOIN name='R'/></POSITIVE>")),
      object_with(plane + colour + tree("<POSITIVE region=''/>")),
      object_with(plane + "<REGOIN name='R' type='empty'/>" + tree("<POSITIVE region='R'/>")),
      object_with("<SDF name='S' file='plane.lxn' type='seedin' seedFile='lost.txt'/>" + colour),
      object_with("<SDF name='S' function='yes'>return 1.0;</SDF>" + colour),
      object_with("<SDF name='S' fiel='plane.lxn'/>" + colour),
      object_with("<SDF name='S' file='plane.lxn' type='seeding' seedFiel='lost.txt'/>" + colour),
      object_with(plane + colour +
                  tree("<POSITIVE><SDF name='S' fiel='plane.lxn'><POSITIVE region='R'/>"
                       "<NEGATIVE region='R'/></SDF></POSITIVE>")),
      object_with(plane + "<REGION name='R' tpye='empty'/>"),
      object_with(plane + "<REGION nmae='R' type='empty'/>"),
      object_with(plane + "<REGION name='R' type='empty' rgb='1 0 0'/>"),
      "<MVV><IMPORT file='lost.voml'/>" + object_with(embed).substr(5),
      "<MVV><OBJCT name='A.B'><REGION/></OBJCT>" + object_with(embed).substr(5),
      "<MVVV>" + object_with(colour).substr(5, object_with(colour).size() - 11) + "</MVVV>",
      "<MVV><OBJET name='A'/></MVV>",
      "<OBJECT name='A'/>",
      "<MVV><OBJECT name='A'>",
  };
  for (const std::string& text : texts) {
    CAPTURE(text);
    const auto reading = read_text(text, {{"plane.lxn", tests::lxn()}}, {.root = "A", .load_everything = true});
    CAPTURE(reading.messages);
    CHECK(reading.errors + reading.warnings == 1);
  }
}

TEST_CASE("a byte order mark and CR LF line ends do not move the places") {
  const auto reading =
      read_text("\xef\xbb\xbf<?xml version='1.0'?>\r\n<MVV>\r\n\t<OBJECT name='A' tag='\xc3\xa4' x='1'>" +
                empty_region + "</OBJECT>\r\n</MVV>\r\n");
  CHECK(reading.messages.find("scene.voml:3:19: warning") != std::string::npos);
  CHECK(reading.messages.find("scene.voml:3:27: warning") != std::string::npos);
}

TEST_CASE("closing tags at fault: inside a prolog, comments, quotes and CDATA nothing is mistaken for a tag") {
  const auto reading = read_text(
      "<?xml version='1.0'?><!DOCTYPE MVV><!-- <a> --><MVV><OBJECT name='a>b' id=\"'\"><SDF name='S' function='1'>"
      "<![CDATA[<b></c>]]></SDF><REGION name='R'/></OBJEKT></MVV>");
  CHECK(reading.messages.find("the closing tag 'OBJEKT' does not close 'OBJECT', which is open") != std::string::npos);
  CHECK(read_text("<MVV></MVV></MVV>").messages.find("closes nothing") != std::string::npos);
}

TEST_CASE("an unreadable scene is one error without a place") {
  const auto reading = read({}, {}, "lost.voml");
  CHECK(reading.messages == "error[E0001]: cannot read 'lost.voml': no such file\n1 error\n");
}

TEST_CASE("an embedding cycle by way of another object's region is found") {
  // A embeds B in its region R; B's tree uses that very region.
  const auto reading = read_text(
      "<MVV><OBJECT name='A'><REGION name='R.A' type='color' rgb='1 0 0'><EMBEDDED name='B'/></REGION></OBJECT>"
      "<OBJECT name='B'><MAPPINGS><REGION name='R.A'/></MAPPINGS></OBJECT></MVV>");
  CHECK(reading.errors == 1);
  CHECK(reading.messages.find("error[E0110]: the object 'B' embeds itself: B -> B") != std::string::npos);
}

TEST_CASE("what many objects embed is no cycle") {
  scene_of("<MVV><OBJECT name='L'>" + empty_region +
           "</OBJECT>"
           "<OBJECT name='A'><REGION name='R' type='empty'><EMBEDDED name='L'/><EMBEDDED name='L'/></REGION></OBJECT>"
           "<OBJECT name='B'><REGION name='R' type='empty'><EMBEDDED name='L'/><EMBEDDED "
           "name='A'/></REGION></OBJECT></MVV>");
}
