// dmvv info FILE: what is in a scene, a distance grid, a mesh or a picture, and what it costs.
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <set>
#include <string_view>

#include "cli/commands.h"
#include "cli/grid_statistics.h"
#include "cli/options.h"
#include "compiler/inventory.h"
#include "voml/assets/grid.h"
#include "voml/assets/image_file.h"

namespace dmvv::cli {
namespace {

struct InfoOptions {
  SceneOptions file;  ///< of any kind
  CodegenChoice codegen;
};

std::string text(const glm::dvec3& v) { return fmt::format("({:.6g} {:.6g} {:.6g})", v.x, v.y, v.z); }

std::string memory(std::size_t bytes) {
  if (bytes < 10'000) return fmt::format("{} bytes", bytes);
  if (bytes < 10'000'000) return fmt::format("{:.1f} KiB", static_cast<double>(bytes) / 1024.0);
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / 1024.0 / 1024.0);
}

// ---- LXN ----

std::string grid_text(const std::string& path, const voml::Grid& grid, std::size_t bytes) {
  const GridStatistics s = measure(grid);
  return fmt::format(
      "{}: distance grid (LXN), {}\n"
      "  size         {} x {} x {}\n"
      "  box          {} to {}\n"
      "  values       {:.6g} to {:.6g}, {:.1f} % of the samples inside\n"
      "  Lipschitz    {:.4g} along x, {:.4g} along y, {:.4g} along z; gradient at most {:.4g} (a distance has 1)\n",
      path, memory(bytes), grid.size.x, grid.size.y, grid.size.z, text(grid.box_lo), text(grid.box_hi), s.least,
      s.greatest, 100.0 * s.share_inside, s.lipschitz.x, s.lipschitz.y, s.lipschitz.z, s.greatest_gradient);
}

// ---- scenes ----

/// The objects of a scene as an indented tree, with what compiling made of each if it could be compiled. An object that
/// stands in it twice is spelled out once.
class SceneTree {
 public:
  SceneTree(const voml::Scene& scene, const compiler::Inventory* inventory) : scene_(scene), inventory_(inventory) {}

  std::string print() {
    print_object(scene_.root, "", 0);
    return std::move(text_);
  }

 private:
  /// Nodes and regions that an object's decisions lead to, each once, in the order met.
  struct Content {
    std::size_t decisions = 0;
    std::vector<Id<voml::Region>> regions;
  };

  Content content(Id<voml::Object> object) const {
    Content result;
    std::set<Id<voml::Node>> seen;
    std::set<Id<voml::Region>> regions;
    std::vector<Id<voml::Node>> open{at(scene_.objects, object).root};
    while (!open.empty()) {
      const Id<voml::Node> id = open.back();
      open.pop_back();
      if (!seen.insert(id).second) continue;
      if (const auto* decision = std::get_if<voml::Decision>(&at(scene_.nodes, id).content)) {
        ++result.decisions;
        open.push_back(decision->negative);
        open.push_back(decision->positive);
      } else if (const auto region = std::get<Id<voml::Region>>(at(scene_.nodes, id).content);
                 regions.insert(region).second) {
        result.regions.push_back(region);
      }
    }
    return result;
  }

  /// How many objects an EMBEDDED element stands for.
  std::size_t instances(const voml::Embedded& embedded) const {
    return embedded.placement == voml::Placement::seeded ? at(scene_.seed_lists, embedded.seeds).seeds.size() : 1;
  }

  void print_object(Id<voml::Object> id, const std::string& prefix, std::size_t depth) {
    const bool again = !printed_.insert(id).second;
    const Content inside = content(id);
    text_ += fmt::format("{:{}}{}{}: ", "", 2 + 2 * depth, prefix, at(scene_.objects, id).name);
    text_ +=
        again ? "as above\n"
              : fmt::format("{}, {}\n", plural(inside.decisions, "decision"), plural(inside.regions.size(), "region"));
    if (again) return;
    if (inventory_) print_compiled(id, depth + 1);
    for (const Id<voml::Region> region : inside.regions) print_embedded(at(scene_.regions, region), depth + 1);
  }

  const compiler::ObjectInventory* compiled(Id<voml::Object> id) const {
    const auto found =
        std::ranges::find(inventory_->objects, at(scene_.objects, id).name, &compiler::ObjectInventory::name);
    return found == inventory_->objects.end() ? nullptr : &*found;
  }

  void print_compiled(Id<voml::Object> id, std::size_t depth) {
    const auto line = [&](std::string_view what, const std::string& words) {
      text_ += fmt::format("{:{}}{:<7} {}\n", "", 2 + 2 * depth, what, words);
    };
    const compiler::ObjectInventory* object = compiled(id);
    if (!object) return line("code", "left out: no path reaches it");
    line("code", object->codegen);
    line("moves", !object->moving_sdfs.empty() ? fmt::format("{}", fmt::join(object->moving_sdfs, ", "))
                  : moves(id)                  ? "what it embeds"
                                               : "no");
    const std::string texels =
        object->texels == 0 ? "no texels" : fmt::format("{} texels in {}", object->texels, memory(object->texel_bytes));
    line("memory", fmt::format("{} of records for {}; {}", memory(object->record_bytes),
                               plural(object->placements, "placement"), texels));
  }

  /// Whether anything in the object depends on t.
  bool moves(Id<voml::Object> id) {
    if (const auto known = moves_.find(id); known != moves_.end()) return known->second;
    const compiler::ObjectInventory* object = compiled(id);
    bool any = object && !object->moving_sdfs.empty();
    for (const Id<voml::Region> region : content(id).regions) {
      for (const voml::EmbeddingGroup& group : at(scene_.regions, region).groups) {
        for (const voml::Embedded& embedded : group.embedded) any = moves(embedded.object) || any;
      }
    }
    return moves_[id] = any;
  }

  void print_embedded(const voml::Region& region, std::size_t depth) {
    std::vector<Id<voml::Object>> order;
    std::map<Id<voml::Object>, std::size_t> counts;
    for (const voml::EmbeddingGroup& group : region.groups) {
      for (const voml::Embedded& embedded : group.embedded) {
        if (!counts.contains(embedded.object)) order.push_back(embedded.object);
        counts[embedded.object] += instances(embedded);
      }
    }
    for (const Id<voml::Object> object : order) {
      print_object(object, fmt::format("{}: {} x ", region.name, counts[object]), depth);
    }
  }

  const voml::Scene& scene_;
  const compiler::Inventory* inventory_;  // null: the scene cannot be compiled
  std::string text_;
  std::set<Id<voml::Object>> printed_;
  std::map<Id<voml::Object>, bool> moves_;
};

std::string assets_text(const voml::Scene& scene) {
  std::string result;
  const auto line = [&](std::string_view kind, const std::string& path, const std::string& what, std::size_t bytes) {
    result += fmt::format("  {:<8} {}: {}\n", kind, path,
                          bytes == 0 ? "not needed, not opened" : what + ", " + memory(bytes));
  };
  for (const voml::Grid& grid : scene.grids) {
    line("grid", grid.path, fmt::format("{} x {} x {}", grid.size.x, grid.size.y, grid.size.z),
         grid.values.size() * sizeof(float));
  }
  for (const voml::Bitmap& bitmap : scene.bitmaps) {
    line("bitmap", bitmap.path, fmt::format("{0} x {0} x {0}", bitmap.n), bitmap.texels.size() * sizeof(glm::u8vec4));
  }
  for (const voml::SeedList& list : scene.seed_lists) {
    line("seeds", list.path, plural(list.seeds.size(), "seed"), list.seeds.size() * sizeof(voml::Seed));
  }
  return result.empty() ? "  none\n" : result;
}

/// Counts of what the root reaches.
std::string module_text(const compiler::Module& module) {
  std::size_t candidates = 0, seeds = 0;
  for (const compiler::Region& region : module.regions) {
    for (const compiler::CandidateGroup& group : region.groups) candidates += group.candidates.size();
  }
  for (const compiler::Sdf& sdf : module.sdfs) {
    if (sdf.placement == voml::Placement::seeded) seeds += sdf.local_from_object.size();
  }
  return fmt::format("{}, {}, {}, {}, {}, depth {}", plural(module.objects.size(), "object"),
                     plural(module.sdfs.size(), "SDF"), plural(module.regions.size(), "region"),
                     plural(candidates, "embedded candidate"), plural(seeds, "SDF seed"), module.depth);
}

/// What the passes found, and what is uploaded.
std::string program_text(const compiler::Inventory& inventory, std::uint32_t line_budget) {
  std::string text = "passes\n";
  const auto line = [&](std::string_view what, const std::string& words) {
    text += fmt::format("  {:<16} {}\n", what, words);
  };
  for (const compiler::PassEffect& pass : inventory.passes) line(pass.pass, pass.effect);
  text += "program\n";
  const compiler::Program& program = inventory.program;
  const compiler::Statistics& s = program.statistics;
  const bool specialised = program.codegen != compiler::Codegen::table;
  line("code",
       fmt::format("{} lines of GLSL{}", s.code.glsl_lines,
                   specialised ? fmt::format("; {} when inlined, {} allowed", s.code.inlined_lines, line_budget) : ""));
  line("time", program.time_slots.empty() ? "none: the scene is static"
                                          : plural(program.time_slots.size(), "value") + " a frame");
  std::vector<std::string> parts;
  for (const compiler::Buffer& b : program.buffers) parts.push_back(b.name + ' ' + memory(b.bytes.size()));
  line("buffers", memory(s.bytes.buffers) + (parts.empty() ? "" : fmt::format(": {}", fmt::join(parts, ", "))));
  for (const compiler::Texture& t : program.textures) {
    line(t.name,
         fmt::format("{} x {} x {}, {}{}", t.extent.x, t.extent.y, t.extent.z, memory(t.texels.size()),
                     t.name == "grid_atlas" ? fmt::format(", {:.0f} % in use", 100.0 * s.bytes.atlas_fill) : ""));
  }
  return text;
}

int info_scene(const InfoOptions& options, Context& context) {
  const compiler::CompileOptions form = compile_options(options.codegen);
  if (form.codegen == compiler::Codegen::thesis) {
    fail_usage("--codegen: info knows auto, specialised and table", {"dmvv compile --dump stats tells about thesis"});
  }
  Diagnostics diagnostics(options.file.strict);
  session::Session session = make_session(context);
  const voml::Scene scene = must(session.read(scene_file(options.file), diagnostics), diagnostics, context);
  // A cycle is refused before the tree is printed: lower first.
  compiler::Module module = must(session.lower(scene, diagnostics), diagnostics, context);
  const std::string counts = module_text(module);
  const auto inventory = compiler::take_inventory(std::move(module), form, diagnostics);
  context.stopwatch.lap("compile");
  print_diagnostics(diagnostics, context);
  print_result(fmt::format("{}: scene (VOML), root {}\n  reaches {}\nobjects\n{}assets\n{}{}", options.file.path,
                           at(scene.objects, scene.root).name, counts,
                           SceneTree(scene, inventory ? &*inventory : nullptr).print(), assets_text(scene),
                           inventory ? program_text(*inventory, form.inlined_line_budget) : ""));
  return inventory ? exit_done : exit_input;
}

// ---- meshes and pictures ----

int info_mesh(const std::string& path, Context& context) {
  Diagnostics diagnostics;
  const voml::Mesh mesh = read_mesh(path, context, diagnostics);
  print_diagnostics(diagnostics, context);
  const voml::Bounds box = voml::bounds(mesh);
  const voml::EdgeFaults edges = voml::find_edge_faults(mesh);
  std::string words = fmt::format("{}: mesh, {} vertices, {}\n  box          {} to {}\n  open edges   {}\n", path,
                                  mesh.positions.size(), plural(mesh.triangles.size(), "triangle"), text(box.lo),
                                  text(box.hi), edges.open.count);
  for (const std::string& fault : voml::describe(edges)) words += fmt::format("  not closed   {}\n", fault);
  print_result(words);
  return exit_done;
}

int info_picture(const std::string& path, std::string_view bytes) {
  const auto picture = inspect_image(bytes, path);
  if (!picture && picture.error().fault == Fault::environment) fail_with(picture.error());
  if (!picture) {  // the decoder's words speak of its formats, not of the file
    fail_with(
        {Fault::input, fmt::format("'{}' is no scene, distance grid, mesh or picture that dmvv knows", path), {}});
  }
  const ImageInfo& image = *picture;
  print_result(fmt::format(
      "{}: picture ({}), {} x {}, {} of {}: {}\n  {}\n", path, image.format, image.width, image.height,
      plural(image.channels.size(), "channel"), image.sample_type, fmt::join(image.channels, " "),
      image.height == image.width * image.width ? fmt::format("a bitmap of {0} x {0} x {0} texels", image.width)
                                                : "no bitmap: its height is not the square of its width"));
  return exit_done;
}

// ---- which of them it is ----

bool has_ending(const std::string& path, std::string_view ending) {
  return path.size() >= ending.size() &&
         std::equal(ending.begin(), ending.end(), path.end() - static_cast<std::ptrdiff_t>(ending.size()),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

/// In any encoding: byte order marks and the zeros of UTF-16 and UTF-32 are passed over.
bool starts_like_xml(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  const std::size_t first = bytes.find_first_not_of(std::string_view(" \t\r\n\0\xff\xfe", 7));
  return first != std::string_view::npos && bytes[first] == '<';
}

int info(const InfoOptions& options, Context& context) {
  const std::string& path = options.file.path;
  const std::string bytes = read_bytes(path);
  if (has_ending(path, ".lxn") || std::string_view(bytes).starts_with(std::string_view("LXN\0", 4))) {
    Diagnostics diagnostics(options.file.strict);
    const auto grid = voml::parse_lxn(bytes, diagnostics.add_source(path, ""), diagnostics);
    if (!grid) stop_with(diagnostics, context);
    print_result(grid_text(path, *grid, bytes.size()));
    return exit_done;
  }
  if (has_ending(path, ".voml") || starts_like_xml(bytes)) return info_scene(options, context);
  for (const std::string_view ending : {".obj", ".ply", ".stl", ".off"}) {
    if (has_ending(path, ending)) return info_mesh(path, context);
  }
  return info_picture(path, bytes);
}

}  // namespace

void add_info(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App& command = *app.add_subcommand("info", "Tell what is in a scene, distance grid, mesh or picture");
  command.add_option("FILE", options->file.path, "VOML, LXN, OBJ, PLY, STL, OFF file, or a picture")
      ->required()
      ->type_name("");
  add_root_and_strict(command, options->file);
  add_codegen_options(command, options->codegen);
  add_common_options(command, invocation.context);
  command.footer(
      "Of a scene: the tree of objects; the code made for each, and why; which SDFs depend on t; what the passes of\n"
      "the compiler found; memory of records (buffers) and of texels (distance grids and bitmaps).\n"
      "Example:  dmvv info orange.voml");
  command.callback(
      [&invocation, options] { invocation.command = [options](Context& context) { return info(*options, context); }; });
}

}  // namespace dmvv::cli
