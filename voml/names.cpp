// Names -> ids: trees, embeddings, the root.
#include <fmt/format.h>

#include "base/text.h"
#include "voml/draft.h"
#include "voml/scene_graph.h"

namespace dmvv::voml {
namespace {

/// Something that a name stands for, and the object that defines it.
template <class T>
struct Definition {
  Id<T> id;
  Id<Object> object;
};
template <class T>
using Definitions = std::unordered_map<std::string, std::vector<Definition<T>>>;

std::string_view word_of(Tag kind) { return kind == Tag::sdf ? "SDF" : kind == Tag::region ? "region" : "object"; }

class NameResolver {
 public:
  NameResolver(Draft& draft, Diagnostics& diagnostics) : draft_(draft), scene_(draft.scene), diagnostics_(diagnostics) {
    for (std::uint32_t i = 0; i < draft.names.size(); ++i) {  // objects in order: no result depends on a hash
      if (draft.names[i].is_second) continue;
      for (const auto& [name, id] : draft.names[i].sdfs) sdfs_[name].push_back({id, Id<Object>{i}});
      for (const auto& [name, id] : draft.names[i].regions) regions_[name].push_back({id, Id<Object>{i}});
    }
    for (std::size_t i = 0; i < draft.unknown_elements.size(); ++i) {
      const UnknownElement& unknown = draft.unknown_elements[i];
      if (!unknown.defines.empty()) misspelt_.try_emplace(key(unknown.meant, unknown.defines), i);
    }
  }

  void resolve_trees();
  void resolve_embeddings();
  void choose_root(const std::string& name);
  void report_unknown_elements();

 private:
  static std::string key(Tag kind, const std::string& name) {
    return fmt::format("{} {}", static_cast<int>(kind), name);
  }

  template <class T>
  Id<T> find(const NodeReference& reference, const std::unordered_map<std::string, Id<T>>& own,
             const Definitions<T>& all, const std::vector<T>& owner);
  template <class T>
  void report_unknown(const NodeReference& reference, const Definitions<T>& all, const std::vector<T>& owner);
  bool blame_misspelt_definition(Tag kind, const std::string& name);
  std::string suggest_object(const std::string& name) const;
  std::string object_name(Id<Object> object) const { return in_quotes(at(scene_.objects, object).name); }
  bool suggestions_are_seen() const { return diagnostics_.error_count() < Diagnostics::cap; }

  Draft& draft_;
  Scene& scene_;
  Diagnostics& diagnostics_;
  Definitions<Sdf> sdfs_;
  Definitions<Region> regions_;
  std::unordered_map<std::string, std::size_t> misspelt_;  // kind and name -> unknown element that would define it
};

// ---- trees ----

void NameResolver::resolve_trees() {
  for (const NodeReference& reference : draft_.node_references) {
    const ObjectNames& own = draft_.names[reference.object.index];
    auto& content = at(scene_.nodes, reference.node).content;
    if (reference.kind == Tag::sdf) {
      std::get<Decision>(content).sdf = find(reference, own.sdfs, sdfs_, scene_.sdfs);
    } else {
      content = find(reference, own.regions, regions_, scene_.regions);
    }
  }
}

template <class T>
Id<T> NameResolver::find(const NodeReference& reference, const std::unordered_map<std::string, Id<T>>& own,
                         const Definitions<T>& all, const std::vector<T>& owner) {
  if (const auto found = own.find(reference.name); found != own.end()) return found->second;
  if (blame_misspelt_definition(reference.kind, reference.name)) return {};
  const auto elsewhere = all.find(reference.name);
  if (elsewhere != all.end() && elsewhere->second.size() == 1) {
    const Definition<T>& definition = elsewhere->second.front();
    diagnostics_.report(Code::name_of_other_object, reference.span,
                        fmt::format("the {} {} is not defined in the object {}; the one of the object {} is used",
                                    word_of(reference.kind), in_quotes(reference.name), object_name(reference.object),
                                    object_name(definition.object)),
                        {{at(owner, definition.id).span, "defined here"}});
    return definition.id;
  }
  report_unknown(reference, all, owner);
  return {};
}

template <class T>
void NameResolver::report_unknown(const NodeReference& reference, const Definitions<T>& all,
                                  const std::vector<T>& owner) {
  if (draft_.incomplete) return;  // it may stand in the file that could not be read
  const ObjectNames& names = draft_.names[reference.object.index];
  if (std::is_same_v<T, Sdf> ? names.has_sdf_twice : names.has_region_twice) return;
  for (const ObjectNames& second : draft_.names) {
    if (!second.is_second) continue;
    if (std::is_same_v<T, Sdf> ? second.sdfs.contains(reference.name) : second.regions.contains(reference.name)) return;
  }
  const std::string what = fmt::format("unknown {} {}", word_of(reference.kind), in_quotes(reference.name));
  if (const auto several = all.find(reference.name); several != all.end()) {
    std::vector<Note> notes;
    constexpr std::size_t most_notes = 4;
    for (std::size_t i = 0; i < several->second.size() && i < most_notes; ++i) {
      const Definition<T>& definition = several->second[i];
      notes.push_back(
          {at(owner, definition.id).span, fmt::format("the object {} defines one", object_name(definition.object))});
    }
    diagnostics_.report(Code::unknown_name, reference.span,
                        fmt::format("{}: not in the object {}, and {} others define one", what,
                                    object_name(reference.object), several->second.size()),
                        std::move(notes));
    return;
  }
  std::string suggestion;
  if (suggestions_are_seen()) {
    std::vector<std::string_view> own, others;
    for (const T& thing : owner) {
      const bool is_own = std::is_same_v<T, Sdf> ? names.sdfs.contains(thing.name) : names.regions.contains(thing.name);
      (is_own ? own : others).push_back(thing.name);
    }
    auto near = nearest_name(reference.name, own);
    if (!near) near = nearest_name(reference.name, others);
    if (near) suggestion = fmt::format("; did you mean {}?", in_quotes(*near));
  }
  diagnostics_.report(Code::unknown_name, reference.span, what + suggestion);
}

bool NameResolver::blame_misspelt_definition(Tag kind, const std::string& name) {
  const auto found = misspelt_.find(key(kind, name));
  if (found == misspelt_.end()) return false;
  draft_.unknown_elements[found->second].needed = true;
  return true;
}

// ---- objects ----

std::string NameResolver::suggest_object(const std::string& name) const {
  if (!suggestions_are_seen()) return {};
  std::vector<std::string_view> names;
  for (const Object& object : scene_.objects) names.push_back(object.name);
  const auto near = nearest_name(name, names);
  return near && !near->empty() ? fmt::format("; did you mean {}?", in_quotes(*near)) : "";
}

void NameResolver::resolve_embeddings() {
  for (const ObjectReference& reference : draft_.object_references) {
    if (const auto found = draft_.objects.find(reference.name); found != draft_.objects.end()) {
      at(scene_.regions, reference.region).groups[reference.group].embedded[reference.embedded].object = found->second;
    } else if (!blame_misspelt_definition(Tag::object, reference.name) && !draft_.incomplete &&
               !draft_.has_object_twice) {
      diagnostics_.report(
          Code::unknown_name, reference.span,
          fmt::format("unknown object {}{}", in_quotes(reference.name), suggest_object(reference.name)));
    }
  }
}

void NameResolver::choose_root(const std::string& name) {
  scene_.root = draft_.last_object;
  if (name.empty()) return;
  const auto found = draft_.objects.find(name);
  scene_.root = found != draft_.objects.end() ? found->second : Id<Object>{};
  if (found != draft_.objects.end() || blame_misspelt_definition(Tag::object, name) || draft_.incomplete) return;
  if (draft_.has_object_twice) return;
  diagnostics_.report(
      Code::unknown_name, Span{},
      fmt::format("the root is to be {}, but no object has that name{}", in_quotes(name), suggest_object(name)));
}

void NameResolver::report_unknown_elements() {
  for (const UnknownElement& unknown : draft_.unknown_elements) {
    const std::string suggestion =
        unknown.meant == Tag::unknown ? "" : fmt::format("; did you mean '{}'?", name_of(unknown.meant));
    diagnostics_.report(unknown.needed ? Code::misspelt_element : Code::unknown_element, unknown.span,
                        fmt::format("unknown element {} in {}{}", in_quotes(unknown.name), unknown.parent, suggestion));
  }
}

}  // namespace

void resolve_names(Draft& draft, const ReadOptions& options, Diagnostics& diagnostics) {
  NameResolver resolver(draft, diagnostics);
  resolver.resolve_trees();
  resolver.resolve_embeddings();
  resolver.choose_root(options.root);
  resolver.report_unknown_elements();
  report_embedding_cycles(draft.scene, diagnostics);
}

}  // namespace dmvv::voml
