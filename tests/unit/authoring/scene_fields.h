// Modules of scenes written in a test.
#pragma once

#include <doctest/doctest.h>

#include <map>
#include <string>

#include "authoring/field.h"
#include "compiler/ir/module.h"

namespace dmvv::tests {

/// The module of a scene; more files by name.
inline compiler::Module module_of(const std::string& scene, std::map<std::string, std::string> files = {},
                                  const std::string& root = "") {
  files["s.voml"] = scene;
  Diagnostics diagnostics;
  auto read = voml::read_scene("s.voml", memory_files(std::move(files)), {.root = root}, diagnostics);
  REQUIRE_MESSAGE(read, diagnostics.render());
  auto module = compiler::lower(std::move(*read), diagnostics);
  REQUIRE_MESSAGE(module, diagnostics.render());
  return std::move(*module);
}

/// An object whose cube is a region where its one SDF is not positive, and empty elsewhere.
inline std::string object_of(const std::string& sdf, const std::string& name = "O") {
  return "<OBJECT name=\"" + name + "\">" + sdf + "<REGION name=\"R\" type=\"color\" rgb=\"1 0 0\"/></OBJECT>";
}
inline std::string scene_of(const std::string& sdf) { return "<MVV>" + object_of(sdf) + "</MVV>"; }
inline std::string function(const std::string& body, const std::string& attributes = "") {
  return "<SDF name=\"F\" function=\"true\" " + attributes + "><![CDATA[" + body + "]]></SDF>";
}

inline authoring::Field field_of(const compiler::Module& module, double time_ms = 0.0) {
  const auto sdf = authoring::find_sdf(module, "F");
  REQUIRE(sdf);
  return authoring::Field(module, *sdf, time_ms, 0.1);
}

}  // namespace dmvv::tests
