// dmvv new NAME: a scene to begin with.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/outputs.h"

namespace dmvv::cli {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  std::string name;
};

/// Needs no other file. NAME stands for the name of the root object.
constexpr std::string_view starter_scene = R"(<?xml version="1.0" encoding="UTF-8"?>
<!--
  A ball with a rind, and stones in its flesh. Every object lives in the cube from -1 to 1; distances are negative inside.
-->
<MVV>

  <!-- FUNCTIONS: GLSL for every SDF of this file. <sdf> is the library of shapes: sd_sphere, op_smooth_union, ... -->
  <FUNCTIONS><![CDATA[
    #include <sdf>

    // A ball with dents, which breathes once in four seconds; t is in milliseconds.
    float ball(vec3 p, float t) {
      float radius = 0.80 + 0.03 * sin(6.2831853 * t / 4000.0);
      return sd_sphere(p, radius) + 0.015 * sin(9.0 * p.x) * sin(9.0 * p.y) * sin(9.0 * p.z);
    }
  ]]></FUNCTIONS>

  <!-- OBJECT, the small one: two SDFs and three regions. The text of an SDF is the body of float f(vec3 p, float t). -->
  <OBJECT name="NAME_STONE">
    <SDF name="SHELL" function="true">return sd_ellipsoid(p, vec3(0.9, 0.6, 0.6));</SDF>
    <SDF name="KERNEL" function="true">return sd_ellipsoid(p, vec3(0.65, 0.38, 0.38));</SDF>
    <REGION name="R.OUTSIDE" type="empty"/>
    <REGION name="R.SHELL" type="color" rgb="0.45 0.26 0.13"/>
    <REGION name="R.KERNEL" type="color" rgb="0.95 0.88 0.72"/>
    <!-- MAPPINGS: a tree of questions. Each SDF asks on which side a point is; regions are the answers. -->
    <MAPPINGS name="NAME_STONE">
      <SDF name="SHELL">
        <POSITIVE region="R.OUTSIDE"/>
        <NEGATIVE>
          <SDF name="KERNEL"><POSITIVE region="R.SHELL"/><NEGATIVE region="R.KERNEL"/></SDF>
        </NEGATIVE>
      </SDF>
    </MAPPINGS>
  </OBJECT>

  <!-- The last OBJECT is the root: what is drawn. -->
  <OBJECT name="NAME">
    <SDF name="SURFACE" function="true">return ball(p, t);</SDF>
    <SDF name="RIND" function="true">return ball(p, t) + 0.09;</SDF>
    <REGION name="R.OUTSIDE" type="empty"/>
    <REGION name="R.RIND" type="color" rgb="0.20 0.55 0.35"/>
    <REGION name="R.FLESH" type="color" rgb="0.96 0.55 0.45">
      <!-- EMBEDDED: an object put into a region, its cube scaled, then turned (degrees), then moved. The first wins.
           For thousands, seedFile="places.txt" takes the places from a file; an INDEX around them keeps it fast. -->
      <EMBEDDED name="NAME_STONE" translate="0.38 0 0" rotate="0 0 0" scale="0.16 0.16 0.16"/>
      <EMBEDDED name="NAME_STONE" translate="0.19 0.33 0" rotate="0 0 60" scale="0.16 0.16 0.16"/>
      <EMBEDDED name="NAME_STONE" translate="-0.19 0.33 0" rotate="0 0 120" scale="0.16 0.16 0.16"/>
      <EMBEDDED name="NAME_STONE" translate="-0.38 0 0" rotate="0 0 180" scale="0.16 0.16 0.16"/>
      <EMBEDDED name="NAME_STONE" translate="-0.19 -0.33 0" rotate="0 0 240" scale="0.16 0.16 0.16"/>
      <EMBEDDED name="NAME_STONE" translate="0.19 -0.33 0" rotate="0 0 300" scale="0.16 0.16 0.16"/>
      <EMBEDDED name="NAME_STONE" translate="0 0 -0.38" rotate="0 90 0" scale="0.16 0.16 0.16"/>
    </REGION>
    <MAPPINGS name="NAME">
      <SDF name="SURFACE">
        <POSITIVE region="R.OUTSIDE"/>
        <NEGATIVE>
          <SDF name="RIND"><POSITIVE region="R.RIND"/><NEGATIVE region="R.FLESH"/></SDF>
        </NEGATIVE>
      </SDF>
    </MAPPINGS>
  </OBJECT>

</MVV>
)";

/// Upper-case letters, digits and single underscores, made of the file's stem.
std::string object_name(std::string_view stem) {
  std::string name;
  for (const char c : stem) {
    if (c >= 'a' && c <= 'z') {
      name += static_cast<char>(c - 'a' + 'A');
    } else if ((c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (name.ends_with('_')) name.pop_back();
  return name.empty() ? "SCENE" : name;
}

/// The scene with this name in place of NAME, which begins the names of objects.
std::string scene_for(const std::string& name) {
  constexpr std::string_view placeholder = "\"NAME";
  std::string text(starter_scene);
  for (std::size_t at = text.find(placeholder); at != std::string::npos; at = text.find(placeholder, at + 1)) {
    text.replace(at + 1, placeholder.size() - 1, name);
  }
  return text;
}

/// As a word of a POSIX shell.
std::string shell_word(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_-./+:@%").find(c) != std::string_view::npos;
  };
  if (std::ranges::all_of(text, plain)) return text;
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

int new_scene(const NewOptions& options, Context& context) {
  const std::string file_name = fs::path(options.name).filename().string();
  if (file_name.empty() || file_name == ".voml" || file_name == "." || file_name == "..") {
    fail_usage(fmt::format("'{}' is no name for a scene", options.name), {"try: dmvv new melon"});
  }
  fs::path path(options.name);
  if (path.extension() != ".voml") path += ".voml";
  const std::string stem = path.stem().string();
  std::error_code error;
  if (fs::symlink_status(path, error).type() != fs::file_type::not_found) {
    fail_with({Fault::input,
               fmt::format("'{}' exists; it is left as it is", path.string()),
               {"choose another name, or remove it first"}});
  }
  Outputs outputs;
  outputs.announce(path.string());
  outputs.write_bytes(path.string(), scene_for(object_name(stem)));
  outputs.commit();
  context.stopwatch.lap("write");
  if (context.quiet) return exit_done;
  const fs::path picture = fs::path(path).replace_extension(".png");
  print_result(fmt::format("{}: written. Try next:\n  dmvv check {}\n  dmvv render {} -o {} --cut \"0 0 1 0\"\n",
                           path.string(), shell_word(path.string()), shell_word(path.string()),
                           shell_word(picture.string())));
  return exit_done;
}

}  // namespace

void add_new(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<NewOptions>();
  CLI::App& command = *app.add_subcommand("new", "Write a scene to begin with: small, commented, without other files");
  command.add_option("NAME", options->name, "Writes NAME.voml, which must not exist yet; objects are named after it")
      ->required()
      ->type_name("");
  add_common_options(command, invocation.context);
  command.footer("Example:  dmvv new melon");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return new_scene(*options, context); };
  });
}

}  // namespace dmvv::cli
