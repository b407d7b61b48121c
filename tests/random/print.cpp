#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "tests/random/description.h"
#include "tests/support/random.h"
#include "tests/unit/voml/test_files.h"
#include "voml/assets/grid.h"

namespace dmvv::tests::random_scenes {

namespace {

double distance(const Grid& grid, const glm::dvec3& at) {
  const glm::dvec3 p = at - grid.center;
  const double r = grid.radius;
  switch (grid.shape) {
    case Grid::Shape::plane:
      return p.x;
    case Grid::Shape::ball:
      return glm::length(p) - r;
    case Grid::Shape::box: {
      const glm::dvec3 d = glm::abs(p) - r;
      return glm::length(glm::max(d, glm::dvec3(0.0))) + std::min(std::max({d.x, d.y, d.z}), 0.0);
    }
    case Grid::Shape::torus:
      return std::hypot(std::hypot(p.x, p.z) - r, p.y) - r / 3;
    case Grid::Shape::waves:
      return std::sin(p.x * 4 / r) * std::cos(p.y * 4 / r) + 0.5 * std::sin(p.z * 5 / r);
    case Grid::Shape::constant:
      return r - 0.5;
  }
  return 0.0;
}

std::string numbers(const glm::dvec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

/// Writes one of the scene's documents.
class Printer {
 public:
  Printer(const Scene& scene, bool imported, std::map<std::string, std::string>& files)
      : scene_(scene), style_(scene.style), imported_(imported), files_(files), folder_(imported ? "part/" : "") {}

  std::string document(bool imports) {
    open("MVV", "");
    if (imports) element("IMPORT", attribute("file", "part/part.voml"));
    // A document sees the FUNCTIONS of those it imports.
    if ((imported_ || !imports) && uses_shared_helpers()) functions(shared_helpers());
    for (std::size_t i = scene_.objects.size(); i-- > 0;) {  // the root is the last one
      if (scene_.objects[i].imported == imported_) object(i);
    }
    close("MVV");
    return text_;
  }

 private:
  bool uses_shared_helpers() const {
    return std::any_of(scene_.objects.begin(), scene_.objects.end(), [](const Object& object) {
      return std::any_of(object.sdfs.begin(), object.sdfs.end(), [](const Sdf& sdf) {
        const auto* function = std::get_if<Function>(&sdf.source);
        return function && function->body.find("shared_") != std::string::npos;
      });
    });
  }

  // ---- XML ----

  std::string cased(std::string name) const {
    for (char& c : name) {
      c = static_cast<char>(style_.upper_case ? std::toupper(static_cast<unsigned char>(c))
                                              : std::tolower(static_cast<unsigned char>(c)));
    }
    return name;
  }
  static std::string attribute(std::string_view name, const std::string& value) {
    return fmt::format(" {}=\"{}\"", name, value);
  }
  std::string vector(std::string_view name, const glm::dvec3& v, const glm::dvec3& otherwise) const {
    if (v == otherwise) return {};
    return attribute(name, fmt::format("{1}{0}{2}{0}{3}", style_.commas ? ", " : " ", v.x, v.y, v.z));
  }
  std::string vector(std::string_view name, const glm::uvec3& v) const {
    return attribute(name, fmt::format("{} {} {}", v.x, v.y, v.z));
  }
  std::string transform(const Transform& t) const {
    return vector("translate", t.translate, glm::dvec3(0.0)) + vector("rotate", t.rotate_deg, glm::dvec3(0.0)) +
           vector("scale", t.scale, glm::dvec3(1.0));
  }
  void line(const std::string& text) { text_ += std::string(indent_, ' ') + text + "\n"; }
  void open(const std::string& name, const std::string& attributes) {
    line(fmt::format("<{}{}>", cased(name), attributes));
    indent_ += 2;
  }
  void close(const std::string& name) {
    indent_ -= 2;
    line(fmt::format("</{}>", cased(name)));
  }
  void element(const std::string& name, const std::string& attributes) {
    line(fmt::format("<{}{}/>", cased(name), attributes));
  }
  std::string glsl(std::string_view code) const {
    if (style_.cdata) return fmt::format("<![CDATA[{}]]>", code);
    std::string text;
    for (const char c : code) text += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    return text;
  }
  void functions(std::string_view code) { text_ += fmt::format("<{0}>{1}</{0}>\n", cased("FUNCTIONS"), glsl(code)); }

  // ---- files ----

  std::string file(const std::string& ending, std::string bytes) {
    const std::string name = fmt::format("{}{}.{}", imported_ ? "p" : "f", next_file_++, ending);
    files_[folder_ + name] = std::move(bytes);
    return name;
  }

  std::string placement(Placement placement, const Seeds& seeds) {
    if (placement == Placement::tiled) return attribute("type", "tiling");
    if (placement == Placement::single) return {};
    std::string positions = "# x y z\n", rotates, scales;
    for (const voml::Seed& seed : seeds.lines) {
      positions += numbers(seed.position) + "\n";
      rotates += numbers(seed.rotate_deg) + "\n";
      scales += numbers(seed.scale) + "\n";
    }
    std::string text = attribute("type", "seeding") + attribute("seedFile", file("txt", positions));
    if (seeds.rotates) text += attribute("rotateFile", file("txt", rotates));
    if (seeds.scales) text += attribute("scaleFile", file("txt", scales));
    return text;
  }

  // ---- objects ----

  static std::string sdf_name(Reference r) { return fmt::format("S{}_{}", r.object, r.index); }
  static std::string region_name(Reference r) { return fmt::format("R{}_{}", r.object, r.index); }

  /// The attributes of an SDF's definition, and the text of its element.
  std::string sdf_attributes(Reference r, std::string& content) {
    const Sdf& sdf = scene_.objects[r.object].sdfs[r.index];
    std::string text = attribute("name", sdf_name(r));
    if (const auto* grid = std::get_if<Grid>(&sdf.source)) {
      text += attribute("file", file("lxn", lxn_bytes(*grid)));
    } else {
      text += attribute("function", "true");
      content = glsl(std::get<Function>(sdf.source).body);
    }
    text += placement(sdf.placement, sdf.seeds) + transform(sdf.transform);
    if (sdf.index) text += vector("index", *sdf.index);
    if (sdf.offset != 0.0) text += attribute("offset", fmt::format("{}", sdf.offset));
    return text;
  }

  void region(Reference r) {
    const Region& region = scene_.objects[r.object].regions[r.index];
    std::string text = attribute("name", region_name(r));
    if (region.kind == RegionKind::empty) {
      text += attribute("type", "empty");
    } else if (region.kind == RegionKind::color) {
      text += attribute("type", "color") + vector("rgb", region.rgb, glm::dvec3(-1.0));
    } else {
      text += attribute("type", "bitmap") + attribute("file", file("png", bitmap_bytes(region.bitmap)));
      text += transform(region.transform);
    }
    if (region.opacity != 1.0 && region.kind != RegionKind::empty) {
      text += attribute("opacity", fmt::format("{}", region.opacity));
    }
    if (region.groups.empty()) return element("REGION", text);
    open("REGION", text);
    for (const Group& group : region.groups) {
      if (group.index) open("INDEX", vector("size", group.index->size) + transform(group.index->transform));
      for (const Embedded& child : group.embedded) {
        element("EMBEDDED", attribute("name", fmt::format("O{}", child.object)) +
                                placement(child.placement, child.seeds) + transform(child.transform));
      }
      if (group.index) close("INDEX");
    }
    close("REGION");
  }

  void sdf(Reference r) {
    std::string content;
    const std::string attributes = sdf_attributes(r, content);
    line(fmt::format("<{0}{1}>{2}</{0}>", cased("SDF"), attributes, content));
  }

  /// True if this is the place to define what `r` names, which happens once.
  bool define_here(Reference r, std::size_t object, std::vector<bool>& defined) const {
    if (r.object != object || defined[r.index]) return false;
    defined[r.index] = true;
    return true;
  }

  void tree(const Tree& node, std::size_t object) {
    if (node.sides.empty()) {
      if (define_here(node.what, object, regions_defined_)) return region(node.what);
      return element("REGION", attribute("name", region_name(node.what)));
    }
    std::string attributes = attribute("name", sdf_name(node.what)), content;
    if (define_here(node.what, object, sdfs_defined_)) attributes = sdf_attributes(node.what, content);
    open("SDF", attributes);
    if (!content.empty()) line(content);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::string name = i == 0 ? "POSITIVE" : "NEGATIVE";
      const Tree& side = node.sides[i];
      const bool defined = side.what.object != object || (side.sides.empty() && regions_defined_[side.what.index]);
      if (style_.short_sides && side.sides.empty() && defined) {
        element(name, attribute("region", region_name(side.what)));
        continue;
      }
      open(name, "");
      tree(side, object);
      close(name);
    }
    close("SDF");
  }

  void define_used_elsewhere(const Tree& node, std::size_t object, std::vector<bool>& own_sdfs,
                             std::vector<bool>& own_regions) const {
    if (node.what.object == object) (node.sides.empty() ? own_regions : own_sdfs)[node.what.index] = false;
    for (const Tree& side : node.sides) define_used_elsewhere(side, object, own_sdfs, own_regions);
  }

  void object(std::size_t i) {
    const Object& object = scene_.objects[i];
    open("OBJECT", attribute("name", fmt::format("O{}", i)));
    if (!object.helpers.empty()) functions(object.helpers);
    sdfs_defined_.assign(object.sdfs.size(), true);
    regions_defined_.assign(object.regions.size(), true);
    if (style_.inline_definitions && !object.shorthand)
      define_used_elsewhere(object.tree, i, sdfs_defined_, regions_defined_);
    for (std::uint32_t k = 0; k < object.sdfs.size(); ++k) {
      if (sdfs_defined_[k]) sdf({static_cast<std::uint32_t>(i), k});
    }
    for (std::uint32_t k = 0; k < object.regions.size(); ++k) {
      if (regions_defined_[k]) region({static_cast<std::uint32_t>(i), k});
    }
    if (!object.shorthand) {
      open("MAPPINGS", "");
      tree(object.tree, i);
      close("MAPPINGS");
    }
    close("OBJECT");
  }

  const Scene& scene_;
  Style style_;
  bool imported_;
  std::map<std::string, std::string>& files_;
  std::string folder_;
  std::string text_;
  std::size_t indent_ = 0;
  std::size_t next_file_ = 0;
  std::vector<bool> sdfs_defined_, regions_defined_;  // of the object being written
};

}  // namespace

std::string lxn_bytes(const Grid& grid) {
  voml::Grid out;
  out.size = grid.size;
  out.box_lo = 2.0 * grid.box_lo - 1.0;
  out.box_hi = 2.0 * grid.box_hi - 1.0;
  Random random(grid.noise_seed);
  for (std::uint32_t z = 0; z < grid.size.z; ++z) {
    for (std::uint32_t y = 0; y < grid.size.y; ++y) {
      for (std::uint32_t x = 0; x < grid.size.x; ++x) {
        const glm::dvec3 u = (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(grid.size);
        const double noise = grid.noise == 0.0 ? 0.0 : grid.noise * random.in(-1.0, 1.0);
        out.values.push_back(
            static_cast<float>(grid.gain * (distance(grid, glm::mix(out.box_lo, out.box_hi, u)) + noise)));
      }
    }
  }
  return voml::write_lxn(out);
}

std::string bitmap_bytes(const Bitmap& bitmap) {
  Random random(bitmap.seed);
  const int channels = bitmap.alpha ? 4 : 3;
  const int n = static_cast<int>(bitmap.n);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(n) * n * n * channels);
  for (auto& byte : pixels) byte = static_cast<std::uint8_t>(random.below(256));
  return tests::picture(n, n * n, channels, pixels);
}

std::string shared_helpers() {
  return R"(
#include <sdf>
const float shared_k = 0.125;
struct shared_pair { float a; float b; };
float shared_ring(vec3 p, float r) { return length(vec2(length(p.xz) - r, p.y)) - shared_k; }
float shared_blend(float a, float b) { shared_pair s = shared_pair(a, b); return op_smooth_union(s.a, s.b, 2.0 * shared_k); }
)";
}

std::map<std::string, std::string> print(const Scene& scene) {
  std::map<std::string, std::string> files;
  const bool imports =
      std::any_of(scene.objects.begin(), scene.objects.end(), [](const Object& o) { return o.imported; });
  files["scene.voml"] = Printer(scene, false, files).document(imports);
  if (imports) files["part/part.voml"] = Printer(scene, true, files).document(false);
  return files;
}

}  // namespace dmvv::tests::random_scenes
