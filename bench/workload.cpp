#include "bench/workload.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "bench/random.h"
#include "bench/shapes.h"

namespace dmvv::bench {
namespace {

using Files = std::map<std::string, std::string>;

SceneSource in_memory(std::string name, const std::string& objects, Files files = {}) {
  files["scene.voml"] = "<MVV>\n" + objects + "</MVV>\n";
  SceneSource source;
  source.name = std::move(name);
  source.path = "scene.voml";
  source.files = memory_files(std::move(files));
  return source;
}

std::string region(const std::string& name, std::uint32_t i, const std::string& content = {}) {
  const auto channel = [&](double step) { return 0.25 + 0.75 * std::fmod(0.17 + step * i, 1.0); };
  return fmt::format("<REGION name=\"{}\" type=\"color\" rgb=\"{:.3f} {:.3f} {:.3f}\">{}</REGION>\n", name,
                     channel(0.618), channel(0.382), channel(0.272), content);
}

std::string reference(const std::string& region) { return fmt::format("<REGION name=\"{}\"/>", region); }

std::string decision(const std::string& sdf, const std::string& positive, const std::string& negative) {
  return fmt::format("<SDF name=\"{}\"><POSITIVE>{}</POSITIVE><NEGATIVE>{}</NEGATIVE></SDF>", sdf, positive, negative);
}

std::string object(const std::string& name, const std::string& definitions, const std::string& tree) {
  return fmt::format("<OBJECT name=\"{}\">\n{}<MAPPINGS name=\"{}\">{}</MAPPINGS>\n</OBJECT>\n", name, definitions,
                     name, tree);
}

std::string analytic(const std::string& name, const std::string& body) {
  return fmt::format("<SDF name=\"{}\" function=\"true\">return {};</SDF>\n", name, body);
}

/// `count` places in fractions of the cube's edge: one in each cell of a lattice, moved by chance within it.
std::vector<glm::dvec3> places(std::uint32_t count) {
  const auto side = static_cast<std::uint32_t>(std::ceil(std::cbrt(count)));
  const double cell = 1.0 / side;
  Random random(count);
  std::vector<glm::dvec3> result;
  for (std::uint32_t i = 0; i < count; ++i) {
    // Spread over all cells when there are fewer places than cells.
    const auto c = static_cast<std::uint32_t>(std::uint64_t{i} * side * side * side / count);
    const glm::dvec3 corner(c % side, c / side % side, c / side / side);
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    result.push_back((corner + 0.5 + 0.2 * (glm::dvec3(x, y, z) - 0.5)) * cell - 0.5);
  }
  return result;
}

std::string seed_text(const std::vector<glm::dvec3>& seeds) {
  std::string text;
  for (const glm::dvec3& seed : seeds)
    fmt::format_to(std::back_inserter(text), "{:.7f} {:.7f} {:.7f}\n", seed.x, seed.y, seed.z);
  return text;
}

std::string scale_text(double scale) { return fmt::format("{0:.9g} {0:.9g} {0:.9g}", scale); }

std::string embedded(const std::string& object, const glm::dvec3& translate, double scale) {
  return fmt::format("<EMBEDDED name=\"{}\" translate=\"{:.7f} {:.7f} {:.7f}\" scale=\"{}\"/>", object, translate.x,
                     translate.y, translate.z, scale_text(scale));
}

}  // namespace

SceneSource many_objects(std::uint32_t count) {
  const double cell = 2.0 / std::ceil(std::cbrt(count));
  const std::string ball =
      object("BALL",
             analytic("SKIN", "length(p) - 0.95") + analytic("CORE", "length(p) - 0.6") +
                 "<REGION name=\"OUT\" type=\"empty\"/>\n" + region("SHELL", 1) + region("HEART", 2),
             decision("SKIN", reference("OUT"), decision("CORE", reference("SHELL"), reference("HEART"))));
  const std::string seeds =
      fmt::format("<EMBEDDED name=\"BALL\" seedFile=\"seeds.txt\" scale=\"{}\"/>", scale_text(0.44 * cell));
  return in_memory("objects", ball + object("CUBE", region("GROUND", 3, seeds), reference("GROUND")),
                   {{"seeds.txt", seed_text(places(count))}});
}

SceneSource decision_tree(TreeForm form, Source source, std::uint32_t depth) {
  std::string definitions, tree;
  Files files;
  const auto define = [&](const std::string& name, const std::string& glsl,
                          const std::function<double(const glm::dvec3&)>& f) {
    if (source == Source::analytic) {
      definitions += analytic(name, glsl);
    } else {
      definitions += fmt::format("<SDF name=\"{0}\" file=\"{0}.lxn\"/>\n", name);
      files[name + ".lxn"] = voml::write_lxn(sample_grid(24, f));
    }
  };
  if (form == TreeForm::chain) {
    for (std::uint32_t i = 0; i < depth; ++i) {
      const double radius = 1.4 * (depth - i) / (depth + 1.0);
      define(fmt::format("S{}", i), fmt::format("length(p) - {:.6f}", radius),
             [=](const glm::dvec3& p) { return glm::length(p) - radius; });
      definitions += region(fmt::format("R{}", i), i);
    }
    definitions += region("INNERMOST", depth);
    tree = reference("INNERMOST");
    for (std::uint32_t i = depth; i-- > 0;)
      tree = decision(fmt::format("S{}", i), reference(fmt::format("R{}", i)), tree);
  } else {
    // Node n of a heap; level k halves the cube along axis k % 3, slightly curved so that no two nodes are equal.
    const std::uint32_t nodes = (1u << depth) - 1;
    for (std::uint32_t n = 1; n <= nodes; ++n) {
      const auto level = static_cast<std::uint32_t>(std::floor(std::log2(n)));
      const int axis = static_cast<int>(level % 3);
      const double bend = 0.3 + 0.01 * n, shift = 0.2 * std::sin(n);
      define(fmt::format("S{}", n),
             fmt::format("0.8 * (p.{} - {:.6f} - 0.1 * sin({:.6f} * p.{}))", "xyz"[axis], shift, bend,
                         "xyz"[(axis + 1) % 3]),
             [=](const glm::dvec3& p) { return 0.8 * (p[axis] - shift - 0.1 * std::sin(bend * p[(axis + 1) % 3])); });
    }
    std::vector<std::string> trees(2 * nodes + 2);
    for (std::uint32_t n = 2 * nodes + 1; n > nodes; --n) {
      definitions += region(fmt::format("R{}", n), n);
      trees[n] = reference(fmt::format("R{}", n));
    }
    for (std::uint32_t n = nodes; n >= 1; --n)
      trees[n] = decision(fmt::format("S{}", n), trees[2 * n], trees[2 * n + 1]);
    tree = trees[1];
  }
  return in_memory(
      fmt::format("{} {}", form == TreeForm::chain ? "chain" : "tree", source == Source::grid ? "grids" : "analytic"),
      object("BODY", definitions, tree), std::move(files));
}

SceneSource nested_objects(std::uint32_t depth) {
  std::string objects, inner;
  for (std::uint32_t i = depth; i-- > 0;) {
    const std::string definitions =
        analytic("SKIN", "length(p) - 0.98") + "<REGION name=\"OUT\" type=\"empty\"/>\n" + region("BODY", i, inner);
    objects += object(fmt::format("O{}", i), definitions, decision("SKIN", reference("OUT"), reference("BODY")));
    inner = embedded(fmt::format("O{}", i), {0.01, 0.005, 0.0}, 0.97);
  }
  return in_memory("nested", objects + object("CUBE", region("GROUND", depth, inner), reference("GROUND")));
}

SceneSource many_grids(std::uint32_t count, std::uint32_t n) {
  std::string objects, all;
  Files files;
  const auto where = places(count);
  const double scale = 0.44 * 2.0 / std::ceil(std::cbrt(count));
  for (std::uint32_t i = 0; i < count; ++i) {
    const double bumps = 3.0 + i % 7, height = 0.05 + 0.001 * i;
    files[fmt::format("{}.lxn", i)] = voml::write_lxn(sample_grid(n, [=](const glm::dvec3& p) {
      return glm::length(p) - 0.8 - height * std::sin(bumps * p.x) * std::sin(bumps * p.y) * std::sin(bumps * p.z);
    }));
    const std::string definitions = fmt::format("<SDF name=\"SKIN\" file=\"{}.lxn\"/>\n", i) +
                                    "<REGION name=\"OUT\" type=\"empty\"/>\n" + region("BODY", i);
    objects += object(fmt::format("O{}", i), definitions, decision("SKIN", reference("OUT"), reference("BODY")));
    all += embedded(fmt::format("O{}", i), 2.0 * where[i], scale);
  }
  return in_memory("grids", objects + object("CUBE", region("GROUND", count, all), reference("GROUND")),
                   std::move(files));
}

namespace {

/// Lines of text in the plane, stroke by stroke.
struct Strokes {
  std::vector<std::pair<glm::dvec2, glm::dvec2>> ends;
  double unit;  ///< a letter is 2 wide and 4 high
};

Strokes strokes_of_text(std::uint32_t count) {
  // Strokes of each letter: x and y of both ends, on 3 x 5 points.
  static const std::vector<std::vector<std::string>> letters{{"0004", "0414", "1423", "2321", "2110", "1000"},
                                                             {"1014"},
                                                             {"2404", "0402", "0222", "2220", "2000"},  // DIS
                                                             {"0424", "1014"},
                                                             {"0004", "0424", "2420", "0222"},
                                                             {"0004", "0420", "2024"},  // TAN
                                                             {"2404", "0400", "0020"},
                                                             {"2404", "0400", "0020", "0212"}};  // CE
  constexpr std::uint32_t strokes_a_word = 28, letters_a_line = 16, words_a_line = 2;
  const std::uint32_t lines = (count - 1) / (words_a_line * strokes_a_word) + 1;
  const glm::dvec2 cell(1.9 / letters_a_line, 1.9 / lines);
  Strokes strokes{{}, std::min(0.3 * cell.x, 0.15 * cell.y)};
  for (std::uint32_t place = 0; strokes.ends.size() < count; ++place) {
    const std::uint32_t column = place % letters_a_line, line = place / letters_a_line;
    const glm::dvec2 corner(-0.95 + cell.x * column, 0.95 - cell.y * (line + 0.9));
    for (const std::string& stroke : letters[place % letters.size()]) {
      const auto end = [&](std::size_t k) {
        return corner + strokes.unit * glm::dvec2(stroke[k] - '0', stroke[k + 1] - '0');
      };
      if (strokes.ends.size() < count) strokes.ends.emplace_back(end(0), end(2));
    }
  }
  return strokes;
}

/// Text as paper and ink, seen from the front.
SceneSource page(const std::string& name, const std::string& body) {
  const std::string text = "<SDF name=\"TEXT\" function=\"true\"><![CDATA[" + body + "]]></SDF>\n";
  SceneSource source = in_memory(name, object("PAGE", text + region("PAPER", 3) + region("INK", 7),
                                              decision("TEXT", reference("PAPER"), reference("INK"))));
  source.slice = runtime::Plane{{0.0, 0.0, 1.0}, 0.0};
  return source;
}

}  // namespace

SceneSource large_snippet(std::uint32_t operations) {
  constexpr std::uint32_t operations_a_stroke = 33;
  const Strokes strokes = strokes_of_text(operations / operations_a_stroke + 1);
  const auto text_of = [&](const glm::dvec2& end) {
    return fmt::format("vec3({:.5f}, {:.5f}, {:.5f})", end.x, end.y, 0.1 * strokes.unit * std::sin(9.0 * end.x));
  };
  std::string body = "#include <sdf>\nfloat d = 4.0;\n";
  for (const auto& [from, to] : strokes.ends) {
    body += fmt::format("d = op_smooth_union(d, sd_capsule(p, {}, {}, {:.5f}), {:.5f});\n", text_of(from), text_of(to),
                        0.25 * strokes.unit, 0.3 * strokes.unit);
  }
  return page("large snippet", body + "return d;");
}

std::string expression_text(std::uint32_t operations) {
  constexpr std::uint32_t operations_a_stroke = 20, operations_before = 3;
  std::string body;
  std::uint32_t count = 0;
  const auto operation = [&](const std::string& value) {
    body += fmt::format("float v{} = {};\n", count, value);
    return fmt::format("v{}", count++);
  };
  const std::string x = operation("p.x"), y = operation("p.y");
  std::string d = operation("4.0");
  const std::uint32_t stroke_count =
      operations > operations_before ? (operations - operations_before) / operations_a_stroke : 0;
  if (stroke_count != 0) {
    const Strokes strokes = strokes_of_text(stroke_count);
    double i = 0.0;
    for (const auto& [begin, end] : strokes.ends) {
      // As if written by hand: no two sides lie on one line, so that no operation is done twice.
      const glm::dvec2 from = begin + 0.1 * strokes.unit * glm::dvec2(std::sin(7.1 * i), std::sin(3.3 * i));
      const glm::dvec2 to = end + 0.1 * strokes.unit * glm::dvec2(std::sin(2.7 * i), std::sin(5.9 * i));
      i += 1.0;
      const glm::dvec2 along = glm::normalize(to - from), across(along.y, -along.x);
      const auto beyond = [&](const glm::dvec2& normal, const glm::dvec2& corner) {  // of a side of the stroke
        const std::string a = operation(fmt::format("{:.6f} * {}", normal.x, x));
        const std::string b = operation(fmt::format("{:.6f} * {}", normal.y, y));
        const std::string sum = operation(a + " + " + b);
        return operation(fmt::format("{} - {:.6f}", sum, glm::dot(normal, corner) + 0.25 * strokes.unit));
      };
      const std::string first = beyond(along, to), last = beyond(-along, from);
      const std::string left = beyond(across, from), right = beyond(-across, from);
      const std::string length = operation(fmt::format("max({}, {})", first, last));
      const std::string width = operation(fmt::format("max({}, {})", left, right));
      d = operation(fmt::format("min({}, {})", d, operation(fmt::format("max({}, {})", length, width))));
    }
  }
  while (count < operations) d = operation(fmt::format("max({}, -4.0)", d));
  return body + "return " + d + ";";
}

SceneSource expression(std::uint32_t operations) { return page("expression", expression_text(operations)); }

SceneSource empty_cube() { return in_memory("empty", object("CUBE", region("GROUND", 0), reference("GROUND"))); }

}  // namespace dmvv::bench
