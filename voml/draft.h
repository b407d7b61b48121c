// Inside voml: a scene while it is read: everything is there but what the names refer to.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "voml/assets.h"
#include "voml/scene.h"
#include "voml/xml_document.h"

namespace dmvv::voml {

/// A FUNCTIONS element.
struct FunctionBlock {
  GlslText content;
  Span span;
  std::size_t document = 0;   ///< that it stands in, directly or in an object
  std::uint32_t imports = 0;  ///< how many of the document's imports stand before
};

/// What an object defines, by name, and the FUNCTIONS in it (indices into Draft::function_blocks).
struct ObjectNames {
  std::unordered_map<std::string, Id<Sdf>> sdfs;
  std::unordered_map<std::string, Id<Region>> regions;
  std::vector<std::size_t> function_blocks;
  std::size_t document = 0;  ///< that the object stands in
  // Two definitions of one name may be a typo in one of them: then the name that was meant is no fault of its own.
  bool has_sdf_twice = false;
  bool has_region_twice = false;
  bool is_second = false;  ///< the object's own name is that of an earlier one
};

/// A node of a tree whose SDF or region is given by name.
struct NodeReference {
  Id<Object> object;  ///< the tree's
  Id<Node> node;
  Tag kind;  ///< sdf or region
  std::string name;
  Span span;
};

/// An EMBEDDED element's reference to its object.
struct ObjectReference {
  Id<Region> region;
  std::size_t group;
  std::size_t embedded;
  std::string name;
  Span span;
};

/// An unknown element. A warning by itself; if something is missing that it would have been, it is that error instead.
struct UnknownElement {
  std::string name;
  Span span;
  std::string parent;        ///< the element it stands in
  Tag meant = Tag::unknown;  ///< what it may be a typo of
  std::string defines;       ///< its attribute `name`
  bool needed = false;
};

struct Draft {
  Scene scene;
  Assets assets;
  Id<Object> last_object;          ///< of the document itself, imports left aside
  std::vector<ObjectNames> names;  ///< parallel to scene.objects
  std::vector<FunctionBlock> function_blocks;
  std::vector<std::vector<std::size_t>> document_blocks;  ///< of each document: its FUNCTIONS and those it imports
  std::vector<std::vector<std::size_t>>
      document_imports;                      ///< of each document: those with FUNCTIONS that it imports, in order
  std::vector<Id<Object>> function_objects;  ///< parallel to scene.functions: where each stands
  std::unordered_map<std::string, Id<Object>> objects;
  std::vector<NodeReference> node_references;
  std::vector<ObjectReference> object_references;
  std::vector<UnknownElement> unknown_elements;
  bool has_object_twice = false;
  bool incomplete = false;  ///< a file is missing or malformed: names that it may define are not reported
};

/// Reads a document and what it imports into `draft`: objects, definitions, trees. Errors are reported.
void read_documents(const std::string& path, const ReadFile& files, Draft& draft, Diagnostics& diagnostics);

/// Gives every analytic SDF the FUNCTIONS it may use. Errors: E0005.
void connect_functions(Draft& draft, Diagnostics& diagnostics);

/// Connects names with what they refer to, reports unknown elements, chooses the root, refuses embedding cycles.
void resolve_names(Draft& draft, const ReadOptions& options, Diagnostics& diagnostics);

}  // namespace dmvv::voml
