#include "voml/object_reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace dmvv::voml {
namespace {

/// Where an element may stand, for E0102.
std::string_view place_of(Tag tag) {
  switch (tag) {
    case Tag::mvv:
      return "outermost";
    case Tag::import_file:
    case Tag::object:
      return "in MVV";
    case Tag::sdf:
    case Tag::region:
      return "in OBJECT, MAPPINGS, POSITIVE or NEGATIVE";
    case Tag::index:
      return "in the definition of a REGION";
    case Tag::embedded:
      return "in the definition of a REGION, or in an INDEX there";
    case Tag::mappings:
      return "in OBJECT";
    case Tag::functions:
      return "in MVV or OBJECT";
    default:
      return "in an SDF within MAPPINGS";
  }
}

bool holds(const std::vector<Element>& elements, Tag tag) {
  return std::any_of(elements.begin(), elements.end(), [&](const Element& e) { return e.tag() == tag; });
}

// ---- definitions ----

/// Reads the definitions of SDFs and regions of one object.
class DefinitionReader {
 public:
  DefinitionReader(Id<Object> object, const std::string& path, Draft& draft, Diagnostics& diagnostics)
      : object_(object), path_(path), draft_(draft), scene_(draft.scene), diagnostics_(diagnostics) {}

  /// Which children of a definition have a meaning is the caller's to check. An empty name has been reported.
  Id<Sdf> define_sdf(Element element, Attributes& attributes, const std::string& name);
  Id<Region> define_region(Element element, Attributes& attributes, const std::string& name, const Children& children);

 private:
  FileName file_name(Attributes& attributes, std::string_view attribute, const std::string& name) const {
    return {path_beside(path_, name), attributes.span(attribute)};
  }
  template <class T>
  void register_name(std::unordered_map<std::string, Id<T>>& names, const std::vector<T>& all, Id<T> id, Span span,
                     std::size_t errors_before);

  void read_source(Element element, Attributes& attributes, Sdf& sdf);
  void read_colour(Attributes& attributes, Region& region);
  double read_opacity(Attributes& attributes);
  void read_groups(Id<Region> region, const Children& children);
  void read_embedded(Element element, Id<Region> region, EmbeddingGroup& group);
  Placement read_placement(Attributes& attributes, Placement untyped, Id<SeedList>& seeds);
  Id<SeedList> read_seed_files(Attributes& attributes);

  Id<Object> object_;
  const std::string& path_;
  Draft& draft_;
  Scene& scene_;
  Diagnostics& diagnostics_;
};

template <class T>
void DefinitionReader::register_name(std::unordered_map<std::string, Id<T>>& names, const std::vector<T>& all, Id<T> id,
                                     Span span, std::size_t errors_before) {
  const std::string& name = at(all, id).name;
  if (name.empty()) return;
  const auto [entry, is_new] = names.try_emplace(name, id);
  if (!is_new) {
    ObjectNames& own = draft_.names[object_.index];
    (std::is_same_v<T, Sdf> ? own.has_sdf_twice : own.has_region_twice) = true;
  }
  if (is_new || diagnostics_.error_count() != errors_before) return;  // a broken definition is fault enough
  const std::string_view kind = std::is_same_v<T, Sdf> ? "SDF" : "region";
  diagnostics_.report(Code::duplicate_name, span,
                      fmt::format("the {} {} is defined twice in its object", kind, in_quotes(name)),
                      {{at(all, entry->second).span, "first defined here"}});
}

Id<Sdf> DefinitionReader::define_sdf(Element element, Attributes& attributes, const std::string& name) {
  const std::size_t errors_before = diagnostics_.error_count();
  Sdf sdf;
  sdf.name = name;
  sdf.span = element.name_span();
  read_source(element, attributes, sdf);
  sdf.transform = attributes.transform();
  sdf.index_size = attributes.index_size("index");
  sdf.offset = attributes.number("offset").value_or(0.0);
  sdf.placement = read_placement(attributes, Placement::single, sdf.seeds);
  const Id<Sdf> id = append(scene_.sdfs, std::move(sdf));
  register_name(draft_.names[object_.index].sdfs, scene_.sdfs, id, attributes.span("name"), errors_before);
  return id;
}

/// The grid's file or the function's text.
void DefinitionReader::read_source(Element element, Attributes& attributes, Sdf& sdf) {
  const auto function =
      attributes.choice<bool>("function", {{"true", true}, {"false", false}, {"1", true}, {"0", false}});
  if (attributes.has("function") && !function) return;  // reported
  const bool analytic = function.value_or(false);
  auto body = text_of(element);
  if (!analytic) {
    if (const auto file = attributes.required_text("file", " (or function=\"true\" and a text)")) {
      sdf.source = draft_.assets.add_grid(scene_, file_name(attributes, "file", *file));
    }
    if (body && attributes.has("file")) {
      diagnostics_.report(Code::stray_text, body->words, "this text is ignored: 'function' is not true");
    }
    return;
  }
  attributes.warn_ignored("file", "'function' is true, so the text of the element is the SDF");
  if (!body) {
    diagnostics_.report(Code::missing_function, attributes.span("function"),
                        "'function' is true, but the element has no text that could be the function");
    return;
  }
  sdf.source = append(scene_.functions, Function{std::move(body->content), body->span, {}, {}, nullptr});
  draft_.function_objects.push_back(object_);
}

Id<SeedList> DefinitionReader::read_seed_files(Attributes& attributes) {
  SeedFiles files;
  const auto seeds = attributes.text("seedFile");
  if (seeds) files.seeds = file_name(attributes, "seedFile", *seeds);
  if (const auto rotates = attributes.text("rotateFile")) files.rotates = file_name(attributes, "rotateFile", *rotates);
  if (const auto scales = attributes.text("scaleFile")) files.scales = file_name(attributes, "scaleFile", *scales);
  return seeds ? draft_.assets.add_seeds(scene_, files) : Id<SeedList>{};
}

/// The `type` of an SDF or EMBEDDED, with its seed files if it is seeding; `untyped` is what stands for no type.
Placement DefinitionReader::read_placement(Attributes& attributes, Placement untyped, Id<SeedList>& seeds) {
  const auto type = attributes.choice<Placement>(
      "type", {{"default", Placement::single}, {"seeding", Placement::seeded}, {"tiling", Placement::tiled}});
  if (attributes.has("type") && !type) return untyped;  // reported
  const Placement placement = type.value_or(untyped);
  if (placement == Placement::seeded) {
    if (attributes.require("seedFile", " because its type is seeding")) seeds = read_seed_files(attributes);
    return placement;
  }
  for (const std::string_view name : {"seedFile", "rotateFile", "scaleFile"}) {
    attributes.warn_ignored(
        name, attributes.has("seedFile") ? "the type is not seeding" : "there is no 'seedFile' beside it");
  }
  return placement;
}

Id<Region> DefinitionReader::define_region(Element element, Attributes& attributes, const std::string& name,
                                           const Children& children) {
  const std::size_t errors_before = diagnostics_.error_count();
  Region region;
  region.name = name;
  region.span = element.name_span();
  region.object = object_;
  read_colour(attributes, region);
  region.transform = attributes.transform();
  region.opacity = read_opacity(attributes);
  const Id<Region> id = append(scene_.regions, std::move(region));
  read_groups(id, children);
  register_name(draft_.names[object_.index].regions, scene_.regions, id, attributes.span("name"), errors_before);
  return id;
}

void DefinitionReader::read_colour(Attributes& attributes, Region& region) {
  if (!attributes.require("type", ": color, bitmap or empty")) return;
  const auto kind = attributes.choice<RegionKind>(
      "type", {{"color", RegionKind::color}, {"bitmap", RegionKind::bitmap}, {"empty", RegionKind::empty}});
  if (!kind) return;
  region.kind = *kind;
  if (*kind != RegionKind::color) attributes.warn_ignored("rgb", "the type of the region is not color");
  if (*kind != RegionKind::bitmap) attributes.warn_ignored("file", "the type of the region is not bitmap");
  if (*kind == RegionKind::bitmap) {
    if (const auto file = attributes.required_text("file", " because its type is bitmap")) {
      region.bitmap = draft_.assets.add_bitmap(scene_, file_name(attributes, "file", *file));
    }
  }
  if (*kind != RegionKind::color || !attributes.require("rgb", " because its type is color")) return;
  const auto rgb = attributes.vector("rgb");
  if (!rgb) return;
  region.rgb = *rgb;
  for (const double value : {rgb->r, rgb->g, rgb->b}) {
    if (value >= 0.0 && value <= 1.0) continue;
    diagnostics_.report(Code::out_of_range, attributes.span("rgb"),
                        fmt::format("attribute 'rgb' has the component {}, it must lie in 0..1", value));
    return;
  }
}

double DefinitionReader::read_opacity(Attributes& attributes) {
  const double opacity = attributes.number("opacity").value_or(1.0);
  if (opacity >= 0.0 && opacity <= 1.0) return opacity;
  diagnostics_.report(Code::out_of_range, attributes.span("opacity"),
                      fmt::format("attribute 'opacity' is {}, it must lie in 0..1", opacity));
  return 1.0;
}

/// Each INDEX is a group; EMBEDDED elements between two of them make one without a box.
void DefinitionReader::read_groups(Id<Region> region, const Children& children) {
  std::vector<EmbeddingGroup>& groups = at(scene_.regions, region).groups;
  bool in_run = false;
  for (const Element& child : children.elements) {
    if (child.tag() == Tag::embedded) {
      if (!in_run) groups.emplace_back();
      in_run = true;
      read_embedded(child, region, groups.back());
      continue;
    }
    in_run = false;
    Attributes attributes(child, diagnostics_);
    IndexBox box;
    if (attributes.require("size")) box.size = attributes.index_size("size").value_or(box.size);
    box.transform = attributes.transform();
    attributes.report_unknown();
    groups.emplace_back().index = box;
    for (const Element& embedded : children_of(child, {Tag::embedded}, false, draft_, diagnostics_).elements) {
      read_embedded(embedded, region, groups.back());
    }
  }
}

void DefinitionReader::read_embedded(Element element, Id<Region> region, EmbeddingGroup& group) {
  Attributes attributes(element, diagnostics_);
  Embedded embedded;
  embedded.span = element.name_span();
  const auto name = attributes.required_text("name");
  embedded.transform = attributes.transform();
  const Placement untyped = attributes.has("seedFile") ? Placement::seeded : Placement::single;
  embedded.placement = read_placement(attributes, untyped, embedded.seeds);
  attributes.report_unknown();
  children_of(element, {}, false, draft_, diagnostics_);
  if (name) {
    const auto group_index = static_cast<std::size_t>(&group - at(scene_.regions, region).groups.data());
    draft_.object_references.push_back({region, group_index, group.embedded.size(), *name, attributes.span("name")});
  }
  group.embedded.push_back(std::move(embedded));
}

// ---- the object and its tree ----

class ObjectReader {
 public:
  ObjectReader(DocumentRef document, Draft& draft, Diagnostics& diagnostics)
      : object_(append(draft.scene.objects, Object{})),
        draft_(draft),
        scene_(draft.scene),
        diagnostics_(diagnostics),
        definitions_(object_, document.path, draft, diagnostics) {
    draft_.names.emplace_back().document = document.index;
  }

  Id<Object> read(Element element);

 private:
  /// A branch of a tree that is still to be read. Trees are walked without recursion: they may be thousands deep.
  struct Slot {
    Element element;  ///< MAPPINGS, POSITIVE or NEGATIVE
    Id<Node> parent;  ///< invalid: the tree's root
  };

  Children children(Element element, std::initializer_list<Tag> allowed, bool text_allowed = false) {
    return children_of(element, allowed, text_allowed, draft_, diagnostics_);
  }

  void read_name(Element element);
  void read_definition(Element element);
  void read_mappings(Element element);
  Id<Node> read_branch(Element element);
  Id<Node> read_content(Element element);
  Id<Node> read_decision(Element element);
  void read_sides(Element element, const Children& sides, Id<Node> node);
  void attach(Element branch, Id<Node> parent, Id<Node> node);
  void refer(Tag kind, Id<Node> node, const std::string& name, Span span);
  void expand_shorthand(Element element, const Children& children);

  Id<Object> object_;
  Draft& draft_;
  Scene& scene_;
  Diagnostics& diagnostics_;
  DefinitionReader definitions_;
  std::vector<Id<Sdf>> sdfs_;        // defined directly in the object, for the shorthand without MAPPINGS
  std::vector<Id<Region>> regions_;  // the same
  std::vector<Slot> open_;           // branches to read, the next one last
};

Id<Object> ObjectReader::read(Element element) {
  at(scene_.objects, object_).span = element.name_span();
  read_name(element);
  std::optional<Element> mappings;
  const Children found = children(element, {Tag::sdf, Tag::region, Tag::mappings, Tag::functions});
  for (const Element& child : found.elements) {
    if (child.tag() == Tag::functions) {
      read_functions(child, draft_.names[object_.index].function_blocks, draft_, diagnostics_);
    } else if (child.tag() != Tag::mappings) {
      read_definition(child);
    } else if (mappings) {
      diagnostics_.report(Code::too_many_children, child.name_span(), "an object has one MAPPINGS",
                          {{mappings->name_span(), "the first one stands here"}});
    } else {
      mappings = child;
      read_mappings(child);
    }
  }
  if (!mappings) expand_shorthand(element, found);
  return object_;
}

void ObjectReader::read_name(Element element) {
  Attributes attributes(element, diagnostics_);
  if (const auto name = attributes.required_text("name")) {
    at(scene_.objects, object_).name = *name;
    const auto [entry, is_new] = draft_.objects.try_emplace(*name, object_);
    if (!is_new) {
      draft_.names[object_.index].is_second = draft_.has_object_twice = true;
      diagnostics_.report(Code::duplicate_name, attributes.span("name"),
                          fmt::format("the object {} is defined twice", in_quotes(*name)),
                          {{at(scene_.objects, entry->second).span, "first defined here"}});
    }
  }
  attributes.report_unknown();
}

/// An SDF or REGION directly in the object: always a definition.
void ObjectReader::read_definition(Element element) {
  const bool is_sdf = element.tag() == Tag::sdf;
  Attributes attributes(element, diagnostics_);
  const std::string name = attributes.required_text("name").value_or("");
  if (is_sdf) {
    children(element, {}, true);
    sdfs_.push_back(definitions_.define_sdf(element, attributes, name));
  } else {
    regions_.push_back(
        definitions_.define_region(element, attributes, name, children(element, {Tag::index, Tag::embedded})));
  }
  attributes.report_unknown();
}

void ObjectReader::read_mappings(Element element) {
  Attributes attributes(element, diagnostics_);
  const std::string& own = at(scene_.objects, object_).name;
  const auto name = attributes.text("name");
  if (name && !own.empty() && *name != own) {
    diagnostics_.report(
        Code::wrong_mappings_name, attributes.span("name"),
        fmt::format("these MAPPINGS are for {}, but stand in the object {}", in_quotes(*name), in_quotes(own)));
  }
  attributes.report_unknown();
  open_.push_back({element, {}});
  while (!open_.empty()) {
    const Slot slot = open_.back();
    open_.pop_back();
    attach(slot.element, slot.parent, read_branch(slot.element));
  }
}

void ObjectReader::attach(Element branch, Id<Node> parent, Id<Node> node) {
  if (!parent.valid()) {
    at(scene_.objects, object_).root = node;
    return;
  }
  Decision& decision = std::get<Decision>(at(scene_.nodes, parent).content);
  (branch.tag() == Tag::positive ? decision.positive : decision.negative) = node;
}

/// What stands in MAPPINGS, POSITIVE or NEGATIVE: one SDF or region. Invalid after a report.
Id<Node> ObjectReader::read_branch(Element element) {
  const Children content = children(element, {Tag::sdf, Tag::region});
  std::optional<std::string> region;
  bool has_region = false;
  if (element.tag() != Tag::mappings) {
    Attributes attributes(element, diagnostics_);
    has_region = attributes.has("region");
    region = attributes.text("region");
    if (region && content.elements.empty()) {
      const Id<Node> node = append(scene_.nodes, Node{Id<Region>{}});
      refer(Tag::region, node, *region, attributes.span("region"));
      attributes.report_unknown();
      return node;
    }
    if (!has_region && content.elements.empty() && attributes.has_misspelt("region")) {
      attributes.require("region");
      has_region = true;  // as good as there
    }
    attributes.report_unknown();
  }
  const std::size_t count = content.elements.size() + (has_region ? 1 : 0);
  if (count > 1) {
    diagnostics_.report(Code::too_many_children, content.elements[has_region ? 0 : 1].name_span(),
                        fmt::format("{} holds one SDF or REGION, this is one too many", name_of(element.tag())));
  } else if (count == 0 && !blame_misspelt(content, Tag::sdf, draft_) &&
             !blame_misspelt(content, Tag::region, draft_)) {
    diagnostics_.report(Code::missing_branch, element.name_span(),
                        fmt::format("{} is empty; it needs one SDF or REGION", name_of(element.tag())));
  }
  return content.elements.empty() ? Id<Node>{} : read_content(content.elements.front());
}

/// An SDF or REGION within a tree: a reference if it has only a name, else a definition.
Id<Node> ObjectReader::read_content(Element element) {
  if (element.tag() == Tag::sdf) return read_decision(element);
  const Id<Node> node = append(scene_.nodes, Node{Id<Region>{}});
  Attributes attributes(element, diagnostics_);
  const auto name = attributes.required_text("name");
  const Children embedded = children(element, {Tag::index, Tag::embedded});
  if (attributes.has_other_than("name") || !embedded.elements.empty()) {
    const Id<Region> region = definitions_.define_region(element, attributes, name.value_or(""), embedded);
    at(scene_.nodes, node).content = region;
  } else if (name) {
    refer(Tag::region, node, *name, attributes.span("name"));
  }
  attributes.report_unknown();
  return node;
}

Id<Node> ObjectReader::read_decision(Element element) {
  const Id<Node> node = append(scene_.nodes, Node{Decision{}});
  Attributes attributes(element, diagnostics_);
  const auto name = attributes.required_text("name");
  const Children sides = children(element, {Tag::positive, Tag::negative}, true);
  if (attributes.has_other_than("name")) {
    const Id<Sdf> sdf = definitions_.define_sdf(element, attributes, name.value_or(""));
    std::get<Decision>(at(scene_.nodes, node).content).sdf = sdf;
  } else {
    if (name) refer(Tag::sdf, node, *name, attributes.span("name"));
    if (const auto text = text_of(element)) {
      diagnostics_.report(Code::stray_text, text->words, "this text is ignored: 'function' is not true");
    }
  }
  attributes.report_unknown();
  read_sides(element, sides, node);
  return node;
}

void ObjectReader::read_sides(Element element, const Children& sides, Id<Node> node) {
  std::vector<std::string_view> missing;
  for (const Tag side : {Tag::positive, Tag::negative}) {
    if (!holds(sides.elements, side) && !blame_misspelt(sides, side, draft_)) missing.push_back(name_of(side));
  }
  if (!missing.empty()) {
    diagnostics_.report(Code::missing_branch, element.name_span(),
                        missing.size() == 2 ? "an SDF in a tree needs a POSITIVE and a NEGATIVE side"
                                            : fmt::format("this SDF has no {} side", missing.front()));
  }
  std::optional<Element> seen[2];
  std::vector<Slot> slots;
  for (const Element& side : sides.elements) {
    auto& first = seen[side.tag() == Tag::positive ? 0 : 1];
    if (first) {
      diagnostics_.report(Code::too_many_children, side.name_span(),
                          fmt::format("this SDF has two {} sides", name_of(side.tag())),
                          {{first->name_span(), "the first one stands here"}});
      continue;
    }
    first = side;
    slots.push_back({side, node});
  }
  open_.insert(open_.end(), slots.rbegin(), slots.rend());  // the first one is read next
}

void ObjectReader::refer(Tag kind, Id<Node> node, const std::string& name, Span span) {
  draft_.node_references.push_back({object_, node, kind, name, span});
}

/// An object without MAPPINGS: the negative side of its one SDF is its one region, the positive side is empty.
void ObjectReader::expand_shorthand(Element element, const Children& children) {
  if (blame_misspelt(children, Tag::mappings, draft_)) return;
  if (regions_.size() != 1 || sdfs_.size() > 1) {
    if (regions_.empty() && blame_misspelt(children, Tag::region, draft_)) return;
    const ObjectNames& own = draft_.names[object_.index];
    if (own.has_sdf_twice || own.has_region_twice) return;  // one of the two may be too many
    diagnostics_.report(
        Code::missing_mappings, element.name_span(),
        fmt::format("this object has no MAPPINGS; they may be left out beside one REGION and at most one SDF, but here "
                    "there are {} and {}",
                    regions_.size(), sdfs_.size()));
    return;
  }
  const Id<Node> inside = append(scene_.nodes, Node{regions_.front()});
  at(scene_.objects, object_).root = inside;
  if (sdfs_.empty()) return;
  Region nothing;
  nothing.name = "(empty)";
  nothing.span = element.name_span();
  nothing.object = object_;
  const Id<Node> outside = append(scene_.nodes, Node{append(scene_.regions, nothing)});
  at(scene_.objects, object_).root = append(scene_.nodes, Node{Decision{sdfs_.front(), outside, inside}});
}

}  // namespace

// ---- children ----
namespace {

/// The allowed element that `name` may be a typo of.
Tag meant_by(std::string_view name, std::initializer_list<Tag> allowed) {
  std::vector<std::string_view> candidates;
  for (const Tag tag : allowed) candidates.push_back(name_of(tag));
  const auto near = nearest_name(upper_case(name), candidates);
  return near ? tag_of(*near) : Tag::unknown;
}

}  // namespace

Children children_of(Element parent, std::initializer_list<Tag> allowed, bool text_allowed, Draft& draft,
                     Diagnostics& diagnostics) {
  Children result;
  for (const pugi::xml_node node : parent.node.children()) {
    if (node.type() != pugi::node_element) continue;
    const Element child{parent.document, node};
    const Tag tag = child.tag();
    if (std::find(allowed.begin(), allowed.end(), tag) != allowed.end()) {
      result.elements.push_back(child);
    } else if (tag != Tag::unknown) {
      diagnostics.report(
          Code::misplaced_element, child.name_span(),
          fmt::format("{} cannot stand in {}; it belongs {}", name_of(tag), parent.title(), place_of(tag)));
    } else {
      result.unknown.push_back(draft.unknown_elements.size());
      UnknownElement unknown{std::string(child.name()), child.name_span(), parent.title(),
                             meant_by(child.name(), allowed), std::string(trim(node.attribute("name").value()))};
      draft.unknown_elements.push_back(std::move(unknown));
    }
  }
  const auto text = text_allowed ? std::nullopt : text_of(parent);
  if (text) {
    diagnostics.report(Code::stray_text, text->words,
                       fmt::format("this text is ignored: {} holds no text", parent.title()));
  }
  return result;
}

bool blame_misspelt(const Children& children, Tag wanted, Draft& draft) {
  for (const std::size_t i : children.unknown) {
    if (draft.unknown_elements[i].meant != wanted) continue;
    draft.unknown_elements[i].needed = true;
    return true;
  }
  return false;
}

Id<Object> read_object(Element element, DocumentRef document, Draft& draft, Diagnostics& diagnostics) {
  return ObjectReader(document, draft, diagnostics).read(element);
}

void read_functions(Element element, std::vector<std::size_t>& list, Draft& draft, Diagnostics& diagnostics) {
  Attributes(element, diagnostics).report_unknown();
  children_of(element, {}, true, draft, diagnostics);
  auto text = text_of(element);
  if (!text) return;
  list.push_back(draft.function_blocks.size());
  draft.function_blocks.push_back({std::move(text->content), element.name_span()});
}

}  // namespace dmvv::voml
