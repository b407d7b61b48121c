// The conformance scenes: small, each one feature of the language. Every evaluator must agree on all of them.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/scenes.h"

namespace dmvv::tests {

struct SceneCase {
  std::string name;
  std::string text;
  Files files;
};

inline std::string vector_lines(Random& random, int count, double lo, double hi) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 v = random.point(lo, hi);
    text += fmt::format("{:.6f} {:.6f} {:.6f}\n", v.x, v.y, v.z);
  }
  return text;
}

/// Shells around the origin, one decision within the other, left and right of x = 0 by turns, so that no two ways
/// through the tree are alike. Each third region embeds a cell, alone or in a box, tiled or once, itself or in one that
/// is empty.
inline std::string deep_tree_scene(int decisions) {
  std::string definitions, tree = "<REGION name='R0'/>";
  const auto region = [&](int i) {
    const char* const inner[] = {"",
                                 "<EMBEDDED name='CELL' scale='0.3 0.3 0.3' translate='0.1 0 0'/>",
                                 "",
                                 "<EMBEDDED name='CELL' scale='0.2 0.2 0.2' type='tiling'/>",
                                 "",
                                 ("<INDEX size='1 1 1' translate='0.2 0 0' scale='0.5 0.5 0.5'><EMBEDDED name='PAIR' "
                                  "scale='0.6 0.6 0.6'/></INDEX>"
                                  "<EMBEDDED name='CELL' scale='0.9 0.9 0.9'/>")};
    definitions += fmt::format("<REGION name='R{}' type='{}'{}>{}</REGION>", i, i % 4 == 3 ? "empty" : "color",
                               i % 4 == 3 ? "" : fmt::format(" rgb='{:.3f} 0.3 0.7'", i / 100.0), inner[i % 6]);
  };
  region(0);
  for (int i = 1; i <= decisions; ++i) {
    region(i);
    const double radius = 1.6 * i / (decisions + 1.0);
    definitions += fmt::format("<SDF name='S{0}' function='true'>return length(p) - {1:.5f} + 0.02 * p.{2};</SDF>", i,
                               radius, i % 2 == 0 ? 'x' : 'y');
    tree = fmt::format("<SDF name='S{0}'><POSITIVE><REGION name='R{0}'/></POSITIVE><NEGATIVE>{1}</NEGATIVE></SDF>", i,
                       tree);
  }
  return "<MVV><OBJECT name='CELL'><SDF name='WALL' file='ball.lxn'/><REGION name='NONE' type='empty'/>"
         "<REGION name='PLASMA' type='color' rgb='0 1 0'/><MAPPINGS name='CELL'><SDF name='WALL'><POSITIVE><REGION "
         "name='NONE'/>"
         "</POSITIVE><NEGATIVE><REGION name='PLASMA'/></NEGATIVE></SDF></MAPPINGS></OBJECT>"
         "<OBJECT name='PAIR'><REGION name='LUMEN' type='empty'><EMBEDDED name='CELL' scale='0.5 0.5 0.5' "
         "translate='0.5 0 0'/>"
         "<INDEX size='1 1 1' scale='0.7 0.7 0.7'><EMBEDDED name='CELL' scale='0.4 0.4 0.4' translate='-0.5 0 "
         "0'/></INDEX></REGION></OBJECT>"
         "<OBJECT name='SHELLS'>" +
         definitions + "<MAPPINGS name='SHELLS'>" + tree + "</MAPPINGS></OBJECT></MVV>";
}

/// A chain of `levels` objects, each embedding the next at `scale`, off centre, with a boundary of its own.
inline std::string chain_scene(int levels, double scale) {
  std::string text = "<MVV>\n";
  for (int i = levels - 1; i >= 0; --i) {
    const std::string inner =
        i + 1 < levels
            ? fmt::format("<EMBEDDED name='L{}' translate='0.1 0.05 -0.1' rotate='10 20 30' scale='{} {} {}'/>", i + 1,
                          scale, scale, scale)
            : std::string();
    text += fmt::format(
        "<OBJECT name='L{}'><SDF name='S' file='ball.lxn'/><REGION name='IN' type='color' rgb='{} 0.5 0.2'>{}</REGION>"
        "<REGION name='OUT' type='empty'/><MAPPINGS><SDF name='S'><POSITIVE><REGION name='OUT'/></POSITIVE>"
        "<NEGATIVE><REGION name='IN'/></NEGATIVE></SDF></MAPPINGS></OBJECT>\n",
        i, static_cast<double>(i) / levels, inner);
  }
  return text + "</MVV>\n";
}

/// Lists that hold objects of equal shapes beside others: some answer wherever they are, some by one decision or
/// two, some only by what they embed.
inline std::string strangers_scene() {
  const auto sdf = [](const char* name, const std::string& body) {
    return fmt::format("<SDF name='{}' function='true'>return {};</SDF>", name, body);
  };
  const std::string in_air = "<REGION name='IN' type='color' rgb='1 0.5 0'/><REGION name='AIR' type='empty'/>";
  const std::string by_s =
      "<MAPPINGS><SDF name='S'><POSITIVE region='AIR'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT>";
  std::string text =
      "<MVV><OBJECT name='BRICK'>" + sdf("S", "max(abs(p.x), abs(p.z)) + 0.1 * p.y - 0.3") + in_air + by_s;
  for (const int i : {1, 2, 3}) {
    text +=
        fmt::format("<OBJECT name='BALL{}'>", i) + sdf("S", fmt::format("length(p) - 0.{}", 3 + 2 * i)) + in_air + by_s;
  }
  for (const int i : {1, 2}) {  // a wall around a hole: both sides of what it holds are empty
    text += fmt::format("<OBJECT name='RING{}'>", i) + sdf("S", "length(p) - 0.9") +
            sdf("H", fmt::format("abs(p.x) - 0.{}", 2 * i)) + in_air +
            "<REGION name='HOLE' type='empty'/><MAPPINGS><SDF name='S'><POSITIVE region='AIR'/><NEGATIVE><SDF name='H'>"
            "<POSITIVE region='IN'/><NEGATIVE region='HOLE'/></SDF></NEGATIVE></SDF></MAPPINGS></OBJECT>";
  }
  text += "<OBJECT name='HOLDER'>" + sdf("S", "length(p.xz) - 0.7") +
          "<REGION name='WALL' type='color' rgb='0 0.5 0'/><REGION name='LUMEN' type='empty'><EMBEDDED name='BALL1' "
          "scale='0.6 0.6 0.6'/>"
          "<EMBEDDED name='RING2' translate='0 0.4 0' scale='0.5 0.5 0.5'/></REGION><MAPPINGS><SDF name='S'><POSITIVE "
          "region='WALL'/>"
          "<NEGATIVE region='LUMEN'/></SDF></MAPPINGS></OBJECT><OBJECT name='BLOCK'><REGION name='R' type='color' "
          "rgb='0 0 1'/></OBJECT>";
  const auto list = [](const std::vector<std::string>& objects, double scale) {
    std::string all;
    double turn = 0.0;
    for (const std::string& object : objects) {
      all += fmt::format("<EMBEDDED name='{0}' translate='{1} {2} {3}' rotate='0 {4} 0' scale='{5} {5} {5}'/>", object,
                         0.55 * std::cos(turn), 0.4 * std::sin(2.1 * turn), 0.55 * std::sin(turn), 20.0 * turn, scale);
      turn += 0.7;
    }
    return all;
  };
  text += "<OBJECT name='ROOT'>" + sdf("S", "p.y - 0.2 * p.x") + "<REGION name='ABOVE' type='empty'>" +
          list({"BRICK", "BALL1", "RING1", "BALL2", "BRICK", "RING2", "HOLDER", "BALL3", "BRICK", "BLOCK", "BALL1",
                "HOLDER"},
               0.5) +
          "</REGION><REGION name='BELOW' type='color' rgb='0.3 0.3 0.3'>" +
          list({"RING1", "RING2", "BRICK", "RING2", "HOLDER", "BRICK", "RING1"}, 0.6) + "<INDEX size='3 3 3'>" +
          list({"BRICK", "BALL3", "BRICK", "BALL2", "BRICK"}, 0.7) + "</INDEX></REGION>";
  return text +
         "<MAPPINGS><SDF name='S'><POSITIVE region='ABOVE'/><NEGATIVE region='BELOW'/></SDF></MAPPINGS></OBJECT></MVV>";
}

/// Seeds of one ball in many SDFs that ask one after the other (compiler/passes/seed_chains.h): GRAINS only scale, and
/// whether they answer is told first in a list; of TURNED one only scales; MANY is a long chain that an offset cuts in
/// two, and embeds both.
inline SceneCase seed_chains_case() {
  Random random(11);
  const int count = 18;
  Files files{{"ball.lxn", sphere_lxn(24, 0.8)}, {"r.txt", vector_lines(random, 12, -180, 180)}};
  for (int i = 0; i < count; ++i) {
    files[fmt::format("p{}.txt", i)] = vector_lines(random, 12, -0.8, 0.8);
    std::string scales;
    for (int k = 0; k < 12; ++k)
      scales += fmt::format("{0:.4f} {0:.4f} {0:.4f}\n", 0.12 + 0.1 * random.point(0.0, 1.0).x);
    files[fmt::format("s{}.txt", i)] = scales;
  }
  const auto sdf = [](int i, const std::string& more = {}) {
    return fmt::format("<SDF name='S{0}' type='seeding' file='ball.lxn' seedFile='p{0}.txt' scaleFile='s{0}.txt' {1}/>",
                       i, more);
  };
  const auto object = [](const std::string& name, const std::string& sdfs, int first, int end,
                         const std::string& inside, const std::string& last) {
    std::string regions, tree = "<REGION name='LAST'/>";
    for (int i = end; i-- > first;) {
      regions += fmt::format("<REGION name='R{}' type='color' rgb='{:.3f} 0.4 0.6'>{}</REGION>", i, i / 18.0,
                             i % 3 == 2 ? inside : "");
      tree = fmt::format("<SDF name='S{0}'><POSITIVE>{1}</POSITIVE><NEGATIVE><REGION name='R{0}'/></NEGATIVE></SDF>", i,
                         tree);
    }
    return "<OBJECT name='" + name + "'>" + sdfs + regions + last + "<MAPPINGS name='" + name + "'>" + tree +
           "</MAPPINGS></OBJECT>";
  };
  std::string text =
      "<MVV>" + object("GRAINS", sdf(0) + sdf(1) + sdf(2) + sdf(3), 0, 4, "", "<REGION name='LAST' type='empty'/>");
  const std::string grains =
      "<EMBEDDED name='GRAINS' scale='0.5 0.5 0.5' translate='0.2 0.3 0'/><EMBEDDED name='GRAINS' scale='0.4 0.4 0.4' "
      "translate='-0.4 0 0.2' rotate='10 20 30'/>";
  text += object("TURNED", sdf(4, "rotateFile='r.txt'") + sdf(5) + sdf(6, "rotateFile='r.txt'"), 4, 7, grains,
                 "<REGION name='LAST' type='color' rgb='0 0.2 1'/>");
  std::string many;
  for (int i = 0; i < count; ++i) many += sdf(i, i == 9 ? "offset='0.05'" : "");
  text += object("MANY", many, 0, count, grains,
                 "<REGION name='LAST' type='empty'>" + grains +
                     "<EMBEDDED name='TURNED' scale='0.9 0.9 0.9' translate='0 -0.2 0'/></REGION>");
  return {"seeds of a shape in chains of decisions", text + "</MVV>", files};
}

inline std::vector<SceneCase> make_conformance_scenes() {
  std::vector<SceneCase> scenes;
  const std::string ball = sphere_lxn(24, 0.8);
  const auto one_sdf = [](const std::string& sdf, const std::string& regions) {
    return "<MVV><OBJECT name='A'>" + sdf + regions +
           "<MAPPINGS><SDF name='S'><POSITIVE><REGION name='OUT'/></POSITIVE>"
           "<NEGATIVE><REGION name='IN'/></NEGATIVE></SDF></MAPPINGS></OBJECT></MVV>";
  };
  const std::string in_out =
      "<REGION name='IN' type='color' rgb='1 0 0'/><REGION name='OUT' type='color' rgb='0 0 1'/>";

  scenes.push_back(
      {"cube", "<MVV><OBJECT name='A'><REGION name='R' type='color' rgb='0.2 0.4 0.6'/></OBJECT></MVV>", {}});
  scenes.push_back({"ball", one_sdf("<SDF name='S' file='ball.lxn'/>", in_out), {{"ball.lxn", ball}}});
  scenes.push_back({"offset", one_sdf("<SDF name='S' file='ball.lxn' offset='-0.25'/>", in_out), {{"ball.lxn", ball}}});
  scenes.push_back(
      {"transformed",
       one_sdf("<SDF name='S' file='ball.lxn' translate='0.2 -0.1 0.3' rotate='20 40 60' scale='0.5 0.8 -0.3'/>",
               in_out),
       {{"ball.lxn", ball}}});
  scenes.push_back({"boxed grid",
                    one_sdf("<SDF name='S' file='part.lxn'/>", in_out),
                    {{"part.lxn", voml::write_lxn(grid_of({9, 12, 7}, [](glm::dvec3 p) { return glm::length(p) - 0.7; },
                                                          {-0.5, -0.75, -0.25}, {0.75, 0.5, 0.5}))}}});
  scenes.push_back(
      {"tiled",
       one_sdf("<SDF name='S' type='tiling' file='ball.lxn' scale='0.25 0.25 0.4' rotate='0 0 30'/>", in_out),
       {{"ball.lxn", ball}}});
  Random random(7);
  const Files seeds{{"ball.lxn", ball},
                    {"p.txt", vector_lines(random, 300, -0.5, 0.5)},
                    {"r.txt", vector_lines(random, 300, -180, 180)},
                    {"s.txt", vector_lines(random, 300, 0.03, 0.12)}};
  scenes.push_back(
      {"seeded",
       one_sdf("<SDF name='S' type='seeding' file='ball.lxn' seedFile='p.txt' rotateFile='r.txt' scaleFile='s.txt'/>",
               in_out),
       seeds});
  scenes.push_back({"seeded with coarse index",
                    one_sdf("<SDF name='S' type='seeding' index='3 2 1' file='ball.lxn' seedFile='p.txt' "
                            "rotateFile='r.txt' scaleFile='s.txt'/>",
                            in_out),
                    seeds});

  const std::string cell =
      "<OBJECT name='CELL'><SDF name='WALL' file='ball.lxn'/><SDF name='NUCLEUS' file='ball.lxn' scale='0.4 0.4 0.4' "
      "translate='0.1 0 0'/><REGION name='PLASMA' type='color' rgb='0.9 0.8 0.7'/><REGION name='CORE' type='color' "
      "rgb='0.5 0.1 0.1'/><REGION name='NONE' type='empty'/><MAPPINGS name='CELL'><SDF name='WALL'><POSITIVE "
      "region='NONE'/><NEGATIVE><SDF name='NUCLEUS'><POSITIVE region='PLASMA'/><NEGATIVE region='CORE'/></SDF>"
      "</NEGATIVE></SDF></MAPPINGS></OBJECT>";
  const auto tissue = [&](const std::string& embedded, const std::string& kind = "type='color' rgb='0.3 0.6 0.3'") {
    return "<MVV>" + cell + "<OBJECT name='TISSUE'><REGION name='MATRIX' " + kind + ">" + embedded +
           "</REGION></OBJECT></MVV>";
  };
  scenes.push_back({"embedded seeds",
                    tissue("<EMBEDDED name='CELL' seedFile='p.txt' rotateFile='r.txt' scaleFile='s.txt'/>"), seeds});
  scenes.push_back(
      {"embedded in an empty region",
       tissue("<EMBEDDED name='CELL' seedFile='p.txt' rotateFile='r.txt' scaleFile='s.txt'/>", "type='empty'"), seeds});
  scenes.push_back(
      {"overlapping candidates in order",
       tissue(
           "<EMBEDDED name='CELL' scale='0.5 0.5 0.5'/><EMBEDDED name='CELL' translate='0.3 0 0' scale='0.5 0.5 0.5'/>"
           "<EMBEDDED name='CELL' translate='0 0.3 0' scale='0.5 0.6 0.5' rotate='0 0 45'/>"),
       {{"ball.lxn", ball}}});
  scenes.push_back(
      {"index boxes",
       tissue(
           "<EMBEDDED name='CELL' translate='-0.6 -0.6 0' scale='0.3 0.3 0.3'/><INDEX size='4 4 4' translate='0.25 0 "
           "0' "
           "rotate='0 0 20' scale='0.6 0.9 0.9'><EMBEDDED name='CELL' seedFile='p.txt' rotateFile='r.txt' "
           "scaleFile='s.txt'/>"
           "</INDEX><INDEX size='1 1 1' scale='0.001 0.001 0.001'><EMBEDDED name='CELL' scale='0.5 0.5 0.5'/></INDEX>"),
       seeds});
  scenes.push_back({"tiled embedding",
                    tissue("<EMBEDDED name='CELL' type='tiling' scale='0.2 0.3 0.2' rotate='0 30 0'/>"),
                    {{"ball.lxn", ball}}});
  const auto analytic = [&](const std::string& attributes, const std::string& body) {
    return one_sdf("<SDF name='S' function='true' " + attributes + "><![CDATA[" + body + "]]></SDF>", in_out);
  };
  scenes.push_back({"analytic", analytic("", "return length(p) - 0.7;"), {}});
  scenes.push_back({"analytic, offset and transformed",
                    analytic("offset='0.1' translate='0.2 0 0' rotate='10 20 30' scale='0.7 0.5 0.6'",
                             "vec3 q = abs(p) - 0.5; return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);"),
                    {}});
  scenes.push_back(
      {"analytic, tiled", analytic("type='tiling' scale='0.3 0.2 0.3'", "return length(p.xy) - 0.6;"), {}});
  scenes.push_back({"analytic, seeded",
                    analytic("type='seeding' seedFile='p.txt' rotateFile='r.txt' scaleFile='s.txt'",
                             "return length(vec2(length(p.xz) - 0.6, p.y)) - 0.25;"),
                    seeds});
  scenes.push_back({"analytic, moving",
                    analytic("",
                             "float r = 0.5 + 0.3 * sin(t / 1000.0); vec3 c = vec3(cos(t * 0.001), 0.0, 0.2) * 0.3;"
                             "return length(p - c) - r;"),
                    {}});
  scenes.push_back(
      {"analytic, loops and branches",
       analytic("",
                "float d = 1e9; for (int i = 0; i < 5; ++i) { float a = 6.2831853 * float(i) / 5.0 + t * 0.0005;"
                "vec3 c = 0.5 * vec3(cos(a), sin(a), 0.0); float b = length(p - c) - 0.2;"
                "if (i == 2) { continue; } d = b < d ? b : d; } return d;"),
       {}});
  scenes.push_back(
      {"analytic and grid, embedded by the hundred",
       "<MVV><OBJECT name='BLOB'><SDF name='S' function='true'>return length(p) - 0.6 - 0.2 * sin(t / 500.0 + "
       "p.x);</SDF>"
       "<SDF name='G' file='ball.lxn' scale='0.5 0.5 0.5'/><REGION name='OUT' type='empty'/><REGION name='SKIN' "
       "type='color' "
       "rgb='0.9 0.2 0.2'/><REGION name='HEART' type='color' rgb='0.2 0.2 0.9'/><MAPPINGS><SDF name='S'><POSITIVE "
       "region='OUT'/>"
       "<NEGATIVE><SDF name='G'><POSITIVE region='SKIN'/><NEGATIVE "
       "region='HEART'/></SDF></NEGATIVE></SDF></MAPPINGS></OBJECT>"
       "<OBJECT name='SOUP'><REGION name='WATER' type='color' rgb='0.1 0.1 0.1'><EMBEDDED name='BLOB' seedFile='p.txt' "
       "rotateFile='r.txt' scaleFile='s.txt'/></REGION></OBJECT></MVV>",
       seeds});
  scenes.push_back({"chain of 6", chain_scene(6, 0.7), {{"ball.lxn", ball}}});
  scenes.push_back({"chain of 20", chain_scene(20, 0.9), {{"ball.lxn", ball}}});
  scenes.push_back({"a tree of 24 decisions", deep_tree_scene(24), {{"ball.lxn", ball}}});
  scenes.push_back({"two levels, second comes back empty",
                    "<MVV>" + cell +
                        "<OBJECT name='TUBE'><REGION name='LUMEN' type='empty'><EMBEDDED name='CELL' scale='0.5 0.5 "
                        "0.5'/></REGION></OBJECT>"
                        "<OBJECT name='ROOT'><REGION name='BASE' type='color' rgb='0 0 0'><EMBEDDED name='TUBE' "
                        "scale='0.8 0.8 0.8'/>"
                        "<EMBEDDED name='CELL' scale='0.9 0.9 0.9'/></REGION></OBJECT></MVV>",
                    {{"ball.lxn", ball}}});
  scenes.push_back({"objects of a shape and strangers in one list", strangers_scene(), {}});
  scenes.push_back(seed_chains_case());
  return scenes;
}

inline const std::vector<SceneCase>& conformance_scenes() {
  static const std::vector<SceneCase> scenes = make_conformance_scenes();
  return scenes;
}

/// The scene of that name; there is one.
inline const SceneCase& conformance_scene(const std::string& name) {
  for (const SceneCase& scene : conformance_scenes()) {
    if (scene.name == name) return scene;
  }
  FAIL("no conformance scene named " << name);
  return conformance_scenes().front();
}

}  // namespace dmvv::tests
