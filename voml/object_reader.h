// Inside voml: one OBJECT element -> definitions and tree.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "voml/attributes.h"
#include "voml/draft.h"

namespace dmvv::voml {

/// The child elements that have a meaning at their place, and the unknown ones (indices into Draft::unknown_elements).
struct Children {
  std::vector<Element> elements;
  std::vector<std::size_t> unknown;
};

/// Sorts the children of `parent`: reports elements at a wrong place (E0102) and text (W0105, unless `text_allowed`),
/// and keeps unknown elements for resolve_names.
Children children_of(Element parent, std::initializer_list<Tag> allowed, bool text_allowed, Draft& draft,
                     Diagnostics& diagnostics);

/// If one of the unknown children may be a typo of `wanted`, blames it for the lack of that element: true.
bool blame_misspelt(const Children& children, Tag wanted, Draft& draft);

/// The file that an object stands in.
struct DocumentRef {
  const std::string& path;
  std::size_t index;  ///< into Draft::document_blocks
};

/// Appends the object that `element` defines to the draft.
Id<Object> read_object(Element element, DocumentRef document, Draft& draft, Diagnostics& diagnostics);

/// Appends a FUNCTIONS element to Draft::function_blocks; the list gets its index, unless it has no text.
void read_functions(Element element, std::vector<std::size_t>& list, Draft& draft, Diagnostics& diagnostics);

}  // namespace dmvv::voml
