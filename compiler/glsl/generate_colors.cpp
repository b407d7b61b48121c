// Colours of regions as GLSL.
#include "compiler/glsl/generator.h"
#include "compiler/ir/opacity.h"
#include "compiler/snippet/glsl_literal.h"

namespace dmvv::compiler {

namespace {

constexpr std::size_t most_constant_regions = 24;

}  // namespace

void Generator::emit_colors() {
  const bool constants = !out_.uses.walker && module_.regions.size() <= most_constant_regions;
  out_.uses.bitmap_atlas = !module_.bitmaps.empty();
  out_.uses.region_colors = !constants;
  open("vec4 color_of(uint region, vec3 p)");
  if (constants) {
    emit_constant_colors();
  } else {
    emit_record_colors();
  }
  close();
  line("");
  add("color_of");
}

void Generator::emit_medium_step() {
  // Of bitmaps a share of a texel's width in the root, if nothing enlarges the object.
  open("float medium_step(uint region)");
  line("float step = 3.0e38;");
  for (std::size_t i = 0; i < module_.regions.size(); ++i) {
    const Region& region = module_.regions[i];
    if (region.kind != voml::RegionKind::bitmap || !compiler::is_medium(module_, region)) continue;
    const double texels =
        at(module_.bitmaps, region.bitmap).n * 0.5 * largest_stretch(region.texture_from_object.linear);
    line("if (region == {}u) step = {};", fmt::format("{}", i), glsl_float(static_cast<float>(0.125 / texels)));
  }
  line("return step;");
  close();
  line("");
  add("medium_step");
}

void Generator::emit_constant_colors() {
  line("vec4 color = vec4(0.0);");
  if (out_.uses.bitmap_atlas) {
    line("precise vec3 u = vec3(0.0);");  // all kernels take the same texels, to the bit
    line("vec3 slot_scale = vec3(0.0);");
    line("vec3 slot_offset = vec3(0.0);");
    line("bool bitmap = false;");
  }
  for (std::size_t i = 0; i < module_.regions.size(); ++i) {
    const Region& region = module_.regions[i];
    if (region.number == 0) continue;
    const std::string is_region = fmt::format("if (region == {}u)", i);
    if (region.kind == voml::RegionKind::color) {
      line("{} color = vec4({}, {}, {}, {});  // {}", is_region, glsl_float(static_cast<float>(region.rgb.x)),
           glsl_float(static_cast<float>(region.rgb.y)), glsl_float(static_cast<float>(region.rgb.z)),
           glsl_float(static_cast<float>(region.opacity)), region.name);
      continue;
    }
    open(fmt::format("{}", is_region));
    line("// {}", region.name);
    line("u = {};", affine_expression(region.texture_from_object, "p", options_.fold_affine));
    line("slot_scale = {};", vec3_literal(glm::dvec3(records_.regions[i].slot_scale)));
    line("slot_offset = {};", vec3_literal(glm::dvec3(records_.regions[i].slot_offset)));
    line("color = vec4(1.0, 1.0, 1.0, {});", glsl_float(static_cast<float>(region.opacity)));
    line("bitmap = true;");
    close();
  }
  if (out_.uses.bitmap_atlas) {
    line("precise vec3 slot = fract((u + 1.0) * 0.5) * slot_scale + slot_offset;");
    line("vec4 texel = textureLod(bitmap_atlas, slot, 0.0);");
    line("if (bitmap) color *= texel;");
  }
  line("return color;");
}

void Generator::emit_record_colors() {
  line("vec4 color = regions[region].color;");
  if (out_.uses.bitmap_atlas) {
    line("precise vec3 u = fract((apply(regions[region].texture_from_object, p) + 1.0) * 0.5);");
    line("precise vec3 slot = u * regions[region].slot_scale.xyz + regions[region].slot_offset.xyz;");
    line("vec4 texel = textureLod(bitmap_atlas, slot, 0.0);");
    line("if (regions[region].slot_scale.w != 0.0) color = vec4(texel.rgb, texel.a * color.a);");
  }
  line("return color;");
}

}  // namespace dmvv::compiler
