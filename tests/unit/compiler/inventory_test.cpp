// The inventory: its sums are those of the program, and the passes' effects are those of scenes made for them.
#include "compiler/inventory.h"

#include <doctest/doctest.h>

#include <numeric>

#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::compiler;
using namespace dmvv::tests;

namespace {

Inventory inventory_of(Module module, const CompileOptions& options = {}) {
  Diagnostics diagnostics;
  auto inventory = take_inventory(std::move(module), options, diagnostics);
  INFO(diagnostics.render());
  REQUIRE(inventory.has_value());
  return std::move(*inventory);
}

std::string effect(const Inventory& inventory, std::string_view pass) {
  for (const PassEffect& e : inventory.passes) {
    if (e.pass == pass) return e.effect;
  }
  return "no such pass";
}

const ObjectInventory& object(const Inventory& inventory, std::string_view name) {
  for (const ObjectInventory& o : inventory.objects) {
    if (o.name == name) return o;
  }
  FAIL("no object " << name);
  return inventory.objects.front();
}

// Two grids of the same samples, a tree with equal sides, a list of seeds, an SDF that moves, an embedded object.
const char* const scene = R"(<MVV>
  <OBJECT name="DUST"><REGION name="R.DUST" type="color" rgb="1 1 1"/></OBJECT>
  <OBJECT name="GRAIN">
    <SDF name="A" file="a.lxn"/>
    <SDF name="B" file="b.lxn" rotate="0 0 30"/>
    <REGION name="R.IN" type="color" rgb="1 0 0"/>
    <REGION name="R.OUT" type="empty"/>
    <REGION name="R.NEVER" type="color" rgb="0 0 1"><EMBEDDED name="DUST"/></REGION>
    <MAPPINGS><SDF name="A"><NEGATIVE region="R.IN"/><POSITIVE>
      <SDF name="B"><NEGATIVE region="R.OUT"/><POSITIVE region="R.OUT"/></SDF></POSITIVE></SDF></MAPPINGS>
  </OBJECT>
  <OBJECT name="WALL">
    <SDF name="WAVE" function="true">return p.x - 0.1 * sin(t);</SDF>
    <SDF name="BALLS" function="true" type="seeding" seedFile="s.txt" scale="0.1 0.1 0.1">return length(p) - 0.9;</SDF>
    <REGION name="R.IN" type="color" rgb="1 0 0"><EMBEDDED name="GRAIN" seedFile="s.txt" scale="0.2 0.2 0.2"/></REGION>
    <REGION name="R.BALLS" type="color" rgb="0 1 0"/>
    <REGION name="R.OUT" type="empty"/>
    <MAPPINGS><SDF name="WAVE"><POSITIVE region="R.OUT"/><NEGATIVE>
      <SDF name="BALLS"><NEGATIVE region="R.BALLS"/><POSITIVE region="R.IN"/></SDF></NEGATIVE></SDF></MAPPINGS>
  </OBJECT>
</MVV>)";

Module scene_module() {
  std::string seeds;
  for (int i = 0; i < 20; ++i) seeds += std::to_string(0.02 * i - 0.2) + " 0 0\n";
  return lowered(scene, {{"a.lxn", sphere_lxn(4, 0.8)}, {"b.lxn", sphere_lxn(4, 0.8)}, {"s.txt", seeds}});
}

}  // namespace

TEST_CASE("the records of all objects are the buffers of the program, in every form") {
  for (const bool index : {true, false}) {
    for (const Codegen codegen : {Codegen::specialised, Codegen::table}) {
      CompileOptions options;
      options.codegen = codegen;
      if (!index) options.disabled_passes = {"index"};
      const Inventory inventory = inventory_of(scene_module(), options);
      std::uint64_t records = 0, uploaded = 0;
      for (const ObjectInventory& o : inventory.objects) records += o.record_bytes;
      for (const Buffer& b : inventory.program.buffers)
        uploaded += b.name == "time_values" || b.name == "parameters" ? 0 : b.bytes.size();
      CHECK(records == uploaded);
      CHECK(records > 0);
    }
  }
}

TEST_CASE("counts, texels and what moves, object by object") {
  const Inventory inventory = inventory_of(scene_module());
  const ObjectInventory& wall = object(inventory, "WALL");
  CHECK(wall.decisions == 2);
  CHECK(wall.sdfs == 2);
  CHECK(wall.regions == 3);
  CHECK(wall.placements == 1 + 20 + 20);
  CHECK(wall.moving_sdfs == std::vector<std::string>{"WAVE"});
  CHECK(wall.texels == 0);
  CHECK(wall.codegen == "specialised");
  const ObjectInventory& grain = object(inventory, "GRAIN");
  CHECK(grain.decisions == 1);  // B decides nothing
  CHECK(grain.sdfs == 1);
  CHECK(grain.moving_sdfs.empty());
  CHECK(grain.texels == 64);
  CHECK(grain.texel_bytes == 256);
  CompileOptions half;
  half.atlas_format = TexelFormat::r16f;
  CHECK(object(inventory_of(scene_module(), half), "GRAIN").texel_bytes == 128);
}

TEST_CASE("what the passes found") {
  const Inventory inventory = inventory_of(scene_module());
  CHECK(effect(inventory, "merge-assets") == "grids 2 -> 1");
  CHECK(effect(inventory, "prune-sides") == "decisions 4 -> 3");
  CHECK(effect(inventory, "drop-unreachable") == "SDFs 4 -> 3");
  CHECK(effect(inventory, "index").starts_with("2 lists of 40 entries in "));
  CHECK(effect(inventory, "fold-affine") == "2 of 2 constant transforms turn nothing");  // WAVE and A
  CHECK(effect(inventory, "box-tests") == "2 of 2 box tests are left out");
  CHECK(effect(inventory, "refine-index") == "nothing to do");
  CHECK(effect(inventory, "unite-shapes") == "nothing to do");
  CHECK(effect(inventory, "sink-answers") == "loops ask 1 of 1 objects only whether they answer");
  CHECK(effect(inventory, "stages") == "nothing to do");
  CHECK(effect(inventory, "texel-records") == "");  // no device
  CompileOptions texels;
  texels.max_texel_buffer_elements = 65536;
  CHECK(effect(inventory_of(scene_module(), texels), "texel-records") == "placements, scalings, cells, lists");
  CHECK(inventory.passes.size() == pass_names().size());
}

TEST_CASE("a pass that is off finds nothing, and the others do not change") {
  CompileOptions options;
  options.disabled_passes = {"prune-sides", "index"};
  const Inventory inventory = inventory_of(scene_module(), options);
  CHECK(effect(inventory, "prune-sides") == "off");
  CHECK(effect(inventory, "index") == "off");
  CHECK(effect(inventory, "merge-assets") == "grids 2 -> 1");
  CHECK(effect(inventory, "drop-unreachable") == "nothing to do");
  CHECK(effect(inventory, "fold-affine") == "2 of 3 constant transforms turn nothing");
  CHECK(object(inventory, "GRAIN").decisions == 2);
}

TEST_CASE("the reason of a form is told") {
  CompileOptions options;
  options.inlined_line_budget = 60;
  const Inventory small = inventory_of(scene_module(), options);
  CHECK(object(small, "GRAIN").codegen.starts_with("table, "));
  CHECK((object(small, "GRAIN").codegen + object(small, "WALL").codegen).find("exceed 60 lines") != std::string::npos);
}

TEST_CASE("a module that cannot be compiled gives its error") {
  CompileOptions options;
  options.max_extent_3d = 2;
  Diagnostics diagnostics;
  CHECK(!take_inventory(scene_module(), options, diagnostics));
  CHECK(diagnostics.has_errors());
}
