// Listing 3.1 of the thesis, line numbers taken off, ORANGE_SECTION filled with the least an object can be.
#include "tests/unit/voml/reading.h"

using namespace dmvv;

namespace {

constexpr const char* listing = R"(<MV>

<OBJECT name="ORANGE_SECTION">
  <REGION name="R.SECTION" type="color" rgb="1 0.6 0.1"/>
</OBJECT>

<OBJECT name="ORANGE">
  <SDF name="SKIN" file="sdf/orange_peel.lxn" scale="1.14 1.10 1.12"
    translate="0 0.03 0"/>
 <SDF name="EMPTY_REGION" file="sdf/empty_region.lxn" type="seeding"
   seedFile="seeds/empty_seeds.txt" rotateFile="seeds/empty_rotates.txt"
   scaleFile="seeds/empty_scales.txt"/>

 <REGION name="R.SKIN" type="bitmap" file="bmp/skin_bg.png"
   scale="0.2 0.2 0.2"/>
 <REGION name="R.INNER" type="bitmap" file="bmp/inter_section_bg.png"
   scale="0.06 0.06 0.06" rotate="13 17 19">
   <EMBEDDED name="ORANGE_SECTION" rotate="0 40 0" />
 </REGION>
 <REGION name="R.INNER_EMPTY" type="color"
   rgb="0.1 0.1 0.1" scale="0.1 1 0.1"/>

 <MAPPINGS name="ORANGE">
   <SDF name="SKIN">
     <POSITIVE>
       <REGION name="R.SKIN"/>
     </POSITIVE>
     <NEGATIVE>
       <SDF name="EMPTY_REGION">
         <POSITIVE><REGION name="R.INTER"/></POSITIVE>
         <NEGATIVE><REGION name="R.INNER_EMPTY"/></NEGATIVE>
       </SDF>
     </NEGATIVE>
   </SDF>
 </MAPPINGS>
</OBJECT>

</MV>
)";

std::map<std::string, std::string> listing_files(std::string text) {
  return {{"scene.voml", std::move(text)},
          {"sdf/orange_peel.lxn", tests::lxn()},
          {"sdf/empty_region.lxn", tests::lxn()},
          {"seeds/empty_seeds.txt", "0 0 0\n0.1 0.2 0.3\n"},
          {"seeds/empty_rotates.txt", "0 0 0\n0 90 0\n"},
          {"seeds/empty_scales.txt", "0.1 0.1 0.1\n0.2 0.2 0.2\n"},
          {"bmp/skin_bg.png", tests::picture(2, 4)},
          {"bmp/inter_section_bg.png", tests::picture(2, 4)}};
}

}  // namespace

TEST_CASE("listing 3.1 has one error, the region that is never defined, and one warning, its root's spelling") {
  for (const bool everything : {false, true}) {
    const auto reading = tests::read(listing_files(listing), {.root = "", .load_everything = everything});
    CHECK(reading.messages ==
          "scene.voml:1:2: warning[W0101]: the outermost element is spelt 'MV'; its name is 'MVV'\n"
          "    1 | <MV>\n"
          "      |  ^~\n"
          "scene.voml:30:34: error[E0103]: unknown region 'R.INTER'; did you mean 'R.INNER'?\n"
          "   30 |          <POSITIVE><REGION name=\"R.INTER\"/></POSITIVE>\n"
          "      |                                  ^~~~~~~\n"
          "1 error, 1 warning\n");
  }
}

TEST_CASE("listing 3.1 with that name put right is a scene") {
  std::string text = listing;
  text.replace(text.find("R.INTER"), 7, "R.INNER");
  const auto reading = tests::read(listing_files(text));
  CHECK(reading.errors == 0);
  CHECK(reading.warnings == 1);
  REQUIRE(reading.scene);
  CHECK(at(reading.scene->objects, reading.scene->root).name == "ORANGE");
  REQUIRE(reading.scene->seed_lists.size() == 1);
  CHECK(reading.scene->seed_lists[0].seeds[1].position == glm::dvec3(0.1, 0.2, 0.3));
  CHECK(reading.scene->seed_lists[0].seeds[1].rotate_deg == glm::dvec3(0, 90, 0));
  CHECK(reading.scene->seed_lists[0].seeds[1].scale == glm::dvec3(0.2));
}
