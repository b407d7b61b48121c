// Inside voml: XML with the place of every name, attribute value and text. The only user of pugixml.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "base/text.h"
#include "voml/scene.h"

namespace dmvv::voml {

/// The elements of VOML.
enum class Tag : std::uint8_t {
  mvv,
  import_file,
  object,
  sdf,
  region,
  index,
  embedded,
  mappings,
  positive,
  negative,
  functions,
  unknown,
};

/// "OBJECT"; not for Tag::unknown.
std::string_view name_of(Tag tag);
/// By name, without regard to case; MMV and MV count as MVV.
Tag tag_of(std::string_view name);

/// What pugixml means, in a sentence of ours.
std::string_view what_went_wrong(pugi::xml_parse_status status);

/// A parsed file. Names and values stay where they stood in the file's bytes, so that a pointer is a place.
class XmlDocument {
 public:
  /// Parses the registered bytes of `source`, which become UTF-8 (make_utf8). Errors: E0002..E0005, E0010; then the
  /// result is empty.
  /// `elements_left` is reduced by the number of elements found.
  /// Cost: linear; a second copy of the text.
  static std::unique_ptr<XmlDocument> parse(SourceId source, std::size_t& elements_left, Diagnostics& diagnostics);

  pugi::xml_node root() const { return root_; }
  const Diagnostics& diagnostics() const { return *diagnostics_; }

  Span name_span(pugi::xml_node element) const;
  Span name_span(pugi::xml_attribute attribute) const;
  /// Between the quotes, as written.
  Span value_span(pugi::xml_attribute attribute) const;
  /// The text of a text or CDATA node, as written.
  Span text_span(pugi::xml_node text) const;

 private:
  XmlDocument(SourceId source, const Diagnostics& diagnostics);
  std::string_view original() const { return diagnostics_->source_text(source_); }
  std::uint32_t offset(const char* p) const { return static_cast<std::uint32_t>(p - buffer_.data()); }
  Span span(std::size_t begin, std::size_t end) const;
  void report_parse_error(const pugi::xml_parse_result& result, Diagnostics& diagnostics) const;
  /// If a CDATA section ended too early before the tag, or text, at `at`: reports that.
  bool report_early_cdata_end(std::size_t at, Diagnostics& diagnostics) const;
  bool check_text(pugi::xml_node text, Diagnostics& diagnostics) const;
  bool check_shape(std::size_t& elements_left, Diagnostics& diagnostics);

  SourceId source_;
  const Diagnostics* diagnostics_;
  std::string buffer_;  // pugixml parses in place
  pugi::xml_document document_;
  pugi::xml_node root_;
};

/// An element and the document it belongs to, which must outlive it.
struct Element {
  const XmlDocument* document = nullptr;
  pugi::xml_node node;

  std::string_view name() const { return node.name(); }
  std::string title() const { return upper_case(name()); }  ///< for messages
  Tag tag() const { return tag_of(name()); }
  Span name_span() const { return document->name_span(node); }
};

/// Whether the outermost element is MVV, or nearly so: false if there is no sense in reading on.
/// Reports W0101, E0101.
bool check_root(Element root, Diagnostics& diagnostics);

/// The text of an element, text and CDATA joined. What is left out between (comments, child elements) leaves its line
/// ends behind, so that line k of the text is line k from the beginning of `span`.
struct ElementText {
  GlslText content;
  Span span;
  Span words;  ///< the same without the blanks around it, for messages
};
std::optional<ElementText> text_of(Element element);

}  // namespace dmvv::voml
