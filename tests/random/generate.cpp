#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/random/description.h"
#include "tests/support/random.h"

namespace dmvv::tests::random_scenes {

namespace {

// Analytic SDFs with numbers left open: A in 0.1 to 1, B in -0.5 to 0.5, C in 1 to 9, N in 2 to 5.
constexpr std::string_view templates[] = {
    "return length(p - vec3(B, B, B)) - A;",
    "vec3 d = abs(p) - vec3(A, A, A); return length(max(d, 0.0)) + min(max(d.x, max(d.y, d.z)), 0.0);",
    "return p.x * B + p.y * A + B;",
    "return sin(C * p.x) * cos(C * p.y) + A * sin(C * p.z) - B;",
    "#include <sdf>\nreturn op_smooth_union(sd_sphere(p - vec3(B, 0.0, B), A), sd_box(p, vec3(A, B + 0.6, A)), 0.2);",
    "#include <sdf>\nreturn op_onion(sd_torus(op_rotate_x(p, C), 0.6, 0.2), 0.05);",
    "#include <sdf>\nreturn (sd_sphere(p, 0.6) + A * 0.2 * op_noise(C * p)) / 3.0;",
    "return length(p - B * vec3(sin(t / 700.0), cos(t * 0.001), 0.0)) - A;",
    "float r = A * (1.0 + 0.3 * sin(t / 300.0 + C * p.x)); return max(length(p.xy) - r, abs(p.z) - 0.8);",
    "float d = 8.0; for (int i = 0; i < N; ++i) { float a = float(i) * C + t * 0.0005;\n"
    "  d = min(d, length(p - 0.6 * vec3(cos(a), B, sin(a))) - 0.5 * A); } return d;",
    "if (p.x > B && p.y < A) { return length(p) - A; } else if (p.z > 0.0) { return 0.3; } return p.y - B;",
    "float3 q = frac(p * C * 0.5) * 2.0 - 1.0; return lerp(length(q) - A, p.y, saturate(B + 0.5));",
    "return shared_ring(p, A);",
    "return shared_blend(p.x - B, length(p) - A);",
    "vec3 q = p; for (int i = 0; i < N; ++i) { q = abs(q) - A * 0.5; q.xy = q.yx; if (q.x > 0.9) break; } return "
    "length(q) - 0.3;",
    "return t < 100.0 ? length(p) - A : A - length(p + B);",
    "return A - 0.5;",
    "return p.x / (abs(p.y) - abs(p.y));",
    "mat2 m = mat2(0.8, 0.6, -0.6, 0.8); vec2 q = m * p.xz; float d[2]; d[0] = length(q) - A; d[1] = p.y - B;\n"
    "return max(d[int(p.z > B)], -p.z - 0.9);",
};

/// Draws the parts of a scene.
class Generator {
 public:
  Generator(std::uint64_t seed, const std::vector<NamedSnippet>& snippets) : random_(seed), snippets_(snippets) {}

  Scene scene() {
    Scene scene;
    scene.style = {random_.chance(0.7), random_.chance(0.3), random_.chance(0.3), random_.chance(0.5),
                   random_.chance(0.6)};
    const bool large = random_.chance(0.08);
    const std::uint32_t count = large ? 3 + random_.below(6) : 1 + (random_.below(4) + random_.below(3)) / 2;
    for (std::uint32_t i = 0; i < count; ++i) scene.objects.push_back(object(i, count, large));
    const bool imports = count > 1 && random_.chance(0.25);
    for (std::uint32_t i = 1; imports && i < count; ++i) scene.objects[i].imported = random_.chance(0.6);
    for (std::uint32_t i = 0; i < count; ++i) trees(scene, i, large);
    return scene;
  }

 private:
  // ---- numbers ----

  /// Mostly of few digits, sometimes a round one, sometimes any.
  double number(double lo, double hi) {
    const double x = random_.in(lo, hi);
    const std::uint32_t kind = random_.below(10);
    const double digits = kind < 3 ? 10.0 : kind < 9 ? 1000.0 : 1e9;
    const double rounded = std::round(x * digits) / digits;
    return rounded == 0.0 && lo > 0.0 ? x : rounded;
  }
  glm::dvec3 vector(double lo, double hi) {
    const double x = number(lo, hi), y = number(lo, hi);
    return {x, y, number(lo, hi)};
  }
  double log_uniform(double lo, double hi) { return lo * std::pow(hi / lo, random_.uniform()); }

  glm::dvec3 angles() {
    const std::uint32_t kind = random_.below(10);
    if (kind < 4) return glm::dvec3(0.0);
    if (kind < 6) return 90.0 * (glm::dvec3{random_.below(7), random_.below(7), random_.below(7)} - 3.0);
    return vector(-180.0, 180.0);
  }

  glm::dvec3 scale(double lo, double hi) {
    const double tiny = random_.chance(0.02) ? 1e-3 : 1.0;
    const bool uniform = random_.chance(0.5);
    const double all = log_uniform(lo, hi);
    glm::dvec3 s(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      const double x = (uniform ? all : log_uniform(lo, hi)) * tiny;
      const double digits = std::pow(10.0, 2.0 - std::floor(std::log10(x)));
      s[axis] = std::round(x * digits) / digits * (random_.chance(0.1) ? -1.0 : 1.0);
    }
    return s;
  }

  Transform transform(double reach, double lo, double hi) {
    if (random_.chance(0.2)) return {};
    return {random_.chance(0.2) ? glm::dvec3(0.0) : vector(-reach, reach), angles(), scale(lo, hi)};
  }

  glm::uvec3 cells() { return {1 + random_.below(6), 1 + random_.below(6), 1 + random_.below(6)}; }

  // ---- seeds and placements ----

  Seeds seeds(double lo, double hi, bool large) {
    Seeds made;
    made.rotates = random_.chance(0.5);
    made.scales = random_.chance(0.7);
    const std::uint32_t most = large && random_.chance(0.3) ? 400 : 24;
    const std::uint32_t count = random_.chance(0.03) ? 0 : 1 + random_.below(most);
    for (std::uint32_t i = 0; i < count; ++i) {
      made.lines.push_back({vector(-0.5, 0.5), made.rotates ? angles() : glm::dvec3(0.0),
                            made.scales ? scale(lo, hi) : glm::dvec3(1.0)});
    }
    return made;
  }

  /// Fills in how something stands: once, by seeds, or tiled.
  template <class Placed>
  void place(Placed& placed, double seeding, double tiling, bool large) {
    const double kind = random_.uniform();
    if (kind < seeding) {
      placed.placement = Placement::seeded;
      placed.seeds = seeds(0.06, 0.5, large);
      placed.transform = {
          random_.chance(0.7) ? glm::dvec3(0.0) : vector(-0.3, 0.3), random_.chance(0.7) ? glm::dvec3(0.0) : angles(),
          placed.seeds.scales ? (random_.chance(0.6) ? glm::dvec3(1.0) : scale(0.5, 2.0)) : scale(0.08, 0.6)};
    } else if (kind < seeding + tiling) {
      placed.placement = Placement::tiled;
      placed.transform = transform(1.0, 0.1, 1.0);
    } else {
      placed.transform = transform(0.6, 0.2, 1.4);
    }
  }

  // ---- sources ----

  Grid grid() {
    Grid made;
    made.shape = static_cast<Grid::Shape>(random_.below(random_.chance(0.1) ? 6 : 5));
    const std::uint32_t most = random_.chance(0.06) ? 33 : 9;
    made.size = {1 + random_.below(most), 1 + random_.below(most), 1 + random_.below(most)};
    if (random_.chance(0.35)) {
      for (int axis = 0; axis < 3; ++axis) {
        made.box_lo[axis] = static_cast<float>(number(-0.1, 0.4));
        made.box_hi[axis] = static_cast<float>(number(0.6, 1.1));
      }
    }
    made.center = random_.chance(0.4) ? glm::dvec3(0.0) : vector(-0.4, 0.4);
    made.radius = number(0.2, 1.0);
    made.gain = random_.chance(0.8) ? 1.0 : log_uniform(1e-3, 1e3) * (random_.chance(0.2) ? -1.0 : 1.0);
    made.noise = random_.chance(0.7) ? 0.0 : random_.in(0.0, 1.0);
    made.noise_seed = random_.bits() >> 32;
    return made;
  }

  Function function_of_template(std::string_view text) {
    Function made;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char c = text[i];
      const auto word = [&](std::size_t at) {
        return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '_');
      };
      const bool alone = !word(i + 1) && !(i > 0 && word(i - 1));
      if (c == 'A' && alone)
        made.body += fmt::format("{:.3f}", random_.in(0.1, 1.0));
      else if (c == 'B' && alone)
        made.body += fmt::format("({:.3f})", random_.in(-0.5, 0.5));
      else if (c == 'C' && alone)
        made.body += fmt::format("{:.2f}", random_.in(1.0, 9.0));
      else if (c == 'N' && alone)
        made.body += fmt::format("{}", 2 + random_.below(4));
      else
        made.body += c;
    }
    return made;
  }

  /// From the corpus, whose helpers become those of the object (one snippet with helpers an object), or a template.
  Function function(Object& object) {
    if (!snippets_.empty() && random_.chance(0.2)) {
      const NamedSnippet& snippet = snippets_[random_.below(static_cast<std::uint32_t>(snippets_.size()))];
      if (snippet.helpers.empty() || object.helpers.empty()) {
        if (!snippet.helpers.empty()) object.helpers = snippet.helpers;
        return snippet.function;
      }
    }
    return function_of_template(templates[random_.below(std::size(templates))]);
  }

  // ---- objects ----

  Object object(std::uint32_t index, std::uint32_t count, bool large) {
    Object made;
    made.shorthand = random_.chance(0.2);
    const std::uint32_t sdfs =
        made.shorthand ? random_.below(2) : random_.below(large ? 8 : 4) + (random_.chance(0.5) ? 1 : 0);
    for (std::uint32_t i = 0; i < sdfs; ++i) {
      Sdf sdf;
      if (random_.chance(0.55))
        sdf.source = grid();
      else
        sdf.source = function(made);
      place(sdf, 0.25, 0.15, large);
      if (sdf.placement == Placement::seeded && random_.chance(0.4)) sdf.index = cells();
      if (random_.chance(0.25)) sdf.offset = number(-0.3, 0.3);
      made.sdfs.push_back(std::move(sdf));
    }
    const std::uint32_t regions = made.shorthand ? 1 : 1 + random_.below(4);
    for (std::uint32_t i = 0; i < regions; ++i) made.regions.push_back(region(index, count, large));
    return made;
  }

  Region region(std::uint32_t object, std::uint32_t count, bool large) {
    Region made;
    const double kind = random_.uniform();
    made.kind = kind < 0.6 ? RegionKind::color : kind < 0.8 ? RegionKind::bitmap : RegionKind::empty;
    made.rgb = vector(0.0, 1.0);
    if (random_.chance(0.2)) made.opacity = number(0.0, 1.0);
    if (made.kind == RegionKind::bitmap) {
      made.bitmap = {1 + random_.below(5), random_.chance(0.3), random_.bits() >> 32};
      made.transform = transform(1.0, 0.3, 2.0);
    }
    const bool embeds = object + 1 < count && random_.chance(object == 0 ? 0.85 : 0.6);
    const std::uint32_t groups = embeds ? 1 + random_.below(2) : 0;
    for (std::uint32_t g = 0; g < groups; ++g) {
      Group group;
      if (random_.chance(0.35))
        group.index = voml::IndexBox{cells(), random_.chance(0.4) ? Transform{} : transform(0.3, 0.3, 1.5)};
      const std::uint32_t children = 1 + random_.below(3);
      for (std::uint32_t c = 0; c < children; ++c) {
        Embedded child{object + 1 + random_.below(count - object - 1), {}, {}, {}};
        place(child, 0.45, 0.12, large);
        group.embedded.push_back(std::move(child));
      }
      made.groups.push_back(std::move(group));
    }
    return made;
  }

  // ---- trees ----

  void trees(Scene& scene, std::uint32_t index, bool large) {
    Object& object = scene.objects[index];
    if (!object.shorthand) object.tree = tree(scene, index, large ? 5 : 1 + static_cast<int>(random_.below(3)));
  }

  Tree tree(const Scene& scene, std::uint32_t index, int depth) {
    const Object& object = scene.objects[index];
    const auto own = [&](std::size_t size) {
      return Reference{index, random_.below(static_cast<std::uint32_t>(size))};
    };
    if (depth == 0 || object.sdfs.empty() || random_.chance(0.25)) {
      Reference region = own(object.regions.size());
      // Another object's region may embed only what stands behind this one.
      const std::uint32_t other = random_.below(static_cast<std::uint32_t>(scene.objects.size()));
      if (random_.chance(0.05)) {
        const Reference foreign{other, random_.below(static_cast<std::uint32_t>(scene.objects[other].regions.size()))};
        if (other > index || scene.objects[other].regions[foreign.index].groups.empty()) region = foreign;
      }
      return {region, {}};
    }
    Reference sdf = own(object.sdfs.size());
    const std::uint32_t other = random_.below(static_cast<std::uint32_t>(scene.objects.size()));
    if (random_.chance(0.05) && !scene.objects[other].sdfs.empty()) {
      sdf = {other, random_.below(static_cast<std::uint32_t>(scene.objects[other].sdfs.size()))};
    }
    Tree positive = tree(scene, index, depth - 1);
    return {sdf, {std::move(positive), tree(scene, index, depth - 1)}};
  }

  Random random_;
  const std::vector<NamedSnippet>& snippets_;
};

}  // namespace

Scene generate(std::uint64_t seed, const std::vector<NamedSnippet>& snippets) {
  return Generator(seed, snippets).scene();
}

std::vector<NamedSnippet> read_snippets(const std::string& folder) {
  std::vector<NamedSnippet> snippets;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".glsl") continue;
    std::ifstream file(entry.path());
    std::string text(std::istreambuf_iterator<char>(file), {});
    NamedSnippet snippet{entry.path().stem().string(), {}, {}};
    constexpr std::string_view mark = "// ---- body\n";
    if (const std::size_t at = text.find(mark); at != std::string::npos) {
      snippet.helpers = text.substr(0, at);
      text.erase(0, at + mark.size());
    }
    snippet.function.body = std::move(text);
    snippets.push_back(std::move(snippet));
  }
  std::sort(snippets.begin(), snippets.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return snippets;
}

}  // namespace dmvv::tests::random_scenes
