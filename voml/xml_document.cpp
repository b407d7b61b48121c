#include "voml/xml_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/encoding.h"
#include "base/limits.h"
#include "base/text.h"
#include "voml/glsl_text.h"

namespace dmvv::voml {
namespace {

constexpr std::array<std::string_view, 11> tag_names = {
    "MVV", "IMPORT", "OBJECT", "SDF", "REGION", "INDEX", "EMBEDDED", "MAPPINGS", "POSITIVE", "NEGATIVE", "FUNCTIONS"};

/// An element that is not closed yet; [begin, end) is its name in the opening tag.
struct OpenElement {
  std::size_t begin;
  std::size_t end;
};

/// The elements that are open at `stop`, outermost first: pugixml says where it gave up, not what it waited for.
/// The text before `stop` has been accepted by the parser.
std::vector<OpenElement> open_elements(std::string_view text, std::size_t stop) {
  std::vector<OpenElement> open;
  const auto skip = [&](std::size_t from, std::string_view end) {
    const std::size_t found = text.find(end, from);
    return found == std::string_view::npos ? text.size() : found + end.size();
  };
  for (std::size_t i = text.find('<'); i < stop; i = text.find('<', i)) {
    const std::string_view rest = text.substr(i);
    if (rest.starts_with("<!--")) {
      i = skip(i, "-->");
    } else if (rest.starts_with("<![CDATA[")) {
      i = skip(i, "]]>");
    } else if (rest.starts_with("<?")) {
      i = skip(i, "?>");
    } else if (rest.starts_with("</")) {
      const std::size_t end = skip(i, ">");
      if (i + 2 >= stop || end > stop) break;  // the closing tag at fault
      if (!open.empty()) open.pop_back();
      i = end;
    } else {
      const std::size_t name_end = std::min(text.find_first_of(" \t\r\n/>", i), text.size());
      std::size_t end = name_end;
      for (char quote = 0; end < text.size() && (quote != 0 || text[end] != '>'); ++end) {
        if (quote != 0 ? text[end] == quote : text[end] == '"' || text[end] == '\'') quote = quote != 0 ? 0 : text[end];
      }
      if (end >= stop && end >= text.size()) break;
      if (!rest.starts_with("<!") && text[end - 1] != '/') open.push_back({i + 1, name_end});
      i = end;
    }
  }
  return open;
}

/// The "]]>" that ended a CDATA section before its author wanted it to: the last one before `at`, if only text stands
/// between the two, and another one follows that no CDATA section has begun for.
std::optional<std::size_t> early_cdata_end(std::string_view text, std::size_t at) {
  const std::size_t end = at == 0 ? std::string_view::npos : text.rfind("]]>", at - 1);
  if (end == std::string_view::npos || text.substr(end, at - end).find('<') != std::string_view::npos)
    return std::nullopt;
  const std::size_t second = text.find("]]>", at);
  if (second == std::string_view::npos || text.substr(at, second - at).find("<![CDATA[") != std::string_view::npos) {
    return std::nullopt;
  }
  const std::size_t begin = text.rfind("<![CDATA[", end);
  return begin == std::string_view::npos ? std::nullopt : std::optional(end);
}

constexpr std::string_view cdata_ends_early =
    "this ']]>' ends the CDATA section, and what follows is read as XML; within GLSL write ']] >'";

/// Whether what stands before the tag at `tag` is text: then its '<' may be meant as one.
bool is_within_text(std::string_view text, std::size_t tag) {
  const std::string_view before = trim(text.substr(0, tag));
  return !before.empty() && before.back() != '>';
}

constexpr std::string_view less_than_in_text =
    "; if this '<' is meant as text, write '&lt;', or put the text into <![CDATA[ ]]>";

}  // namespace

std::string_view what_went_wrong(pugi::xml_parse_status status) {
  switch (status) {
    case pugi::status_out_of_memory:
      return "there is not enough memory";
    case pugi::status_unrecognized_tag:
      return "a tag cannot be read here; a '<' that is meant as text is written '&lt;', or the text put into <![CDATA[ "
             "]]>";
    case pugi::status_bad_pi:
      return "this '<?' is never closed by '?>'";
    case pugi::status_bad_comment:
      return "this comment is never closed by '-->'";
    case pugi::status_bad_cdata:
      return "this CDATA section is never closed by ']]>'";
    case pugi::status_bad_doctype:
      return "this DOCTYPE cannot be read";
    case pugi::status_bad_pcdata:
      return "this text cannot be read";
    case pugi::status_bad_start_element:
      return "this opening tag cannot be read; is its '>' missing";
    case pugi::status_bad_attribute:
      return "this attribute cannot be read; an attribute is written name=\"value\"";
    case pugi::status_bad_end_element:
      return "this closing tag cannot be read; is its '>' missing";
    default:
      return "this is not well-formed XML";
  }
}

std::string_view name_of(Tag tag) { return tag_names[static_cast<std::size_t>(tag)]; }

Tag tag_of(std::string_view name) {
  if (same_word(name, "MMV") || same_word(name, "MV")) return Tag::mvv;  // as the thesis prints it
  const auto found =
      std::find_if(tag_names.begin(), tag_names.end(), [&](std::string_view known) { return same_word(known, name); });
  return found == tag_names.end() ? Tag::unknown : Tag{static_cast<std::uint8_t>(found - tag_names.begin())};
}

XmlDocument::XmlDocument(SourceId source, const Diagnostics& diagnostics)
    : source_(source), diagnostics_(&diagnostics), buffer_(diagnostics.source_text(source)) {}

std::unique_ptr<XmlDocument> XmlDocument::parse(SourceId source, std::size_t& elements_left, Diagnostics& diagnostics) {
  if (!make_utf8(source, diagnostics)) return nullptr;
  std::unique_ptr<XmlDocument> result(new XmlDocument(source, diagnostics));
  const std::string_view text = result->original();
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    diagnostics.report(Code::not_utf8_text, result->span(zero, zero), "there is a zero byte; this is no text file");
    return nullptr;
  }
  const auto parsed = result->document_.load_buffer_inplace(
      result->buffer_.data(), result->buffer_.size(), pugi::parse_default | pugi::parse_fragment, pugi::encoding_utf8);
  if (!parsed) {
    result->report_parse_error(parsed, diagnostics);
    return nullptr;
  }
  if (!result->check_shape(elements_left, diagnostics)) return nullptr;
  return result;
}

bool XmlDocument::report_early_cdata_end(std::size_t at, Diagnostics& diagnostics) const {
  const auto end = early_cdata_end(original(), at);
  if (end) diagnostics.report(Code::malformed_xml, span(*end, *end + 3), std::string(cdata_ends_early));
  return end.has_value();
}

void XmlDocument::report_parse_error(const pugi::xml_parse_result& result, Diagnostics& diagnostics) const {
  const std::string_view text = original();
  const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0));
  if (result.status != pugi::status_end_element_mismatch) {
    const std::size_t tag = text.rfind('<', at);
    if (tag != std::string_view::npos && report_early_cdata_end(tag, diagnostics)) return;
    const bool in_text = result.status != pugi::status_unrecognized_tag && tag != std::string_view::npos &&
                         is_within_text(text, tag) && !text.substr(tag).starts_with("<!");
    diagnostics.report(Code::malformed_xml, in_text ? span(tag, tag + 1) : span(at, at),
                       in_text ? fmt::format("the tag that begins here cannot be read{}", less_than_in_text)
                               : std::string(what_went_wrong(result.status)));
    return;
  }
  const std::vector<OpenElement> open = open_elements(text, at);
  const std::size_t name_end = std::min(text.find_first_of("> \t\r\n", at), text.size());
  const std::string closing = in_quotes(text.substr(std::min(at, name_end), name_end - std::min(at, name_end)));
  if (open.empty()) {
    diagnostics.report(Code::malformed_xml, span(at, name_end),
                       fmt::format("the closing tag {} closes nothing", closing));
    return;
  }
  const Span opened = span(open.back().begin, open.back().end);
  if (report_early_cdata_end(opened.begin - 1, diagnostics)) return;
  const std::string_view hint = is_within_text(text, opened.begin - 1) ? less_than_in_text : "";
  const std::string opening = in_quotes(text.substr(opened.begin, opened.end - opened.begin));
  const bool at_closing_tag = at >= 2 && text.substr(at - 2, 2) == "</";
  if (!at_closing_tag) {
    diagnostics.report(Code::malformed_xml, opened, fmt::format("the element {} is never closed{}", opening, hint));
  } else {
    diagnostics.report(Code::malformed_xml, span(at, name_end),
                       fmt::format("the closing tag {} does not close {}, which is open", closing, opening),
                       {{opened, fmt::format("opened here{}", hint)}});
  }
}

/// XML allows no "]]>" in a text; the parser does not mind.
bool XmlDocument::check_text(pugi::xml_node text, Diagnostics& diagnostics) const {
  const Span words = text_span(text);
  const std::size_t found = original().substr(words.begin, words.end - words.begin).find("]]>");
  if (found == std::string_view::npos) return true;
  const std::size_t at = words.begin + found;
  if (!report_early_cdata_end(at, diagnostics)) {
    diagnostics.report(Code::malformed_xml, span(at, at + 3),
                       "']]>' closes no CDATA section; as a text it is written ']]&gt;'");
  }
  return false;
}

/// One outermost element, nothing beside it, not too deep, not too many. Without recursion, as depth is not known yet.
bool XmlDocument::check_shape(std::size_t& elements_left, Diagnostics& diagnostics) {
  for (const pugi::xml_node node : document_.children()) {
    if (node.type() == pugi::node_element && !root_) {
      root_ = node;
    } else if (node.type() == pugi::node_element) {
      diagnostics.report(Code::wrong_root_element, name_span(node),
                         "there is a second outermost element; a scene is one MVV element");
      return false;
    } else if (node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata) {
      diagnostics.report(Code::malformed_xml, text_span(node), "there is text outside of the outermost element");
      return false;
    }
  }
  if (!root_) {
    diagnostics.report(Code::malformed_xml, span(0, 0), "there is no element; a scene is one MVV element");
    return false;
  }
  std::size_t depth = 1;
  for (pugi::xml_node node = root_; node;) {
    if (node.type() == pugi::node_element) {
      if (depth > max_element_depth) {
        diagnostics.report(
            Code::nested_too_deeply, name_span(node),
            fmt::format("this element is nested {} deep, at most {} is allowed", depth, max_element_depth));
        return false;
      }
      if (elements_left == 0) {
        diagnostics.report(Code::scene_too_large, name_span(node),
                           fmt::format("the scene has more than {} elements up to here", max_elements));
        return false;
      }
      --elements_left;
    } else if (node.type() == pugi::node_pcdata && !check_text(node, diagnostics)) {
      return false;
    }
    if (node.first_child()) {
      node = node.first_child();
      ++depth;
      continue;
    }
    while (node != root_ && !node.next_sibling()) {
      node = node.parent();
      --depth;
    }
    node = node == root_ ? pugi::xml_node() : node.next_sibling();
  }
  return true;
}

Span XmlDocument::span(std::size_t begin, std::size_t end) const {
  return {source_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

Span XmlDocument::name_span(pugi::xml_node element) const {
  const std::size_t begin = offset(element.name());
  return span(begin, begin + std::string_view(element.name()).size());
}

Span XmlDocument::name_span(pugi::xml_attribute attribute) const {
  const std::size_t begin = offset(attribute.name());
  return span(begin, begin + std::string_view(attribute.name()).size());
}

Span XmlDocument::value_span(pugi::xml_attribute attribute) const {
  const std::size_t begin = offset(attribute.value());
  return span(begin, std::min(original().find(original()[begin - 1], begin), original().size()));
}

Span XmlDocument::text_span(pugi::xml_node text) const {
  const std::size_t begin = offset(text.value());
  const std::string_view end = text.type() == pugi::node_cdata ? "]]>" : "<";
  return span(begin, std::min(original().find(end, begin), original().size()));
}

bool check_root(Element root, Diagnostics& diagnostics) {
  if (same_word(root.name(), "MVV")) return true;
  if (root.tag() == Tag::mvv) {
    diagnostics.report(Code::root_spelling, root.name_span(),
                       fmt::format("the outermost element is spelt {}; its name is 'MVV'", in_quotes(root.name())));
    return true;
  }
  const bool near = nearest_name(root.title(), {"MVV"}).has_value();
  diagnostics.report(Code::wrong_root_element, root.name_span(),
                     fmt::format("the outermost element is {}, it must be 'MVV'", in_quotes(root.name())));
  return near;
}

std::optional<ElementText> text_of(Element element) {
  std::optional<ElementText> result;
  for (const pugi::xml_node child : element.node.children()) {
    if (child.type() != pugi::node_pcdata && child.type() != pugi::node_cdata) continue;
    const Span part = element.document->text_span(child);
    const std::string& source = element.document->diagnostics().source_text(part.source);
    if (!result) {
      result = ElementText{{}, part, part};
    } else {
      append_line_ends(result->content, source, {part.source, result->span.end, part.begin});
      result->span.end = part.end;
    }
    append_text(result->content, source, part, child.type() == pugi::node_pcdata);
  }
  if (!result || trim(result->content.text).empty()) return std::nullopt;
  const std::string_view source = element.document->diagnostics().source_text(result->span.source);
  const std::string_view words = trim(source.substr(result->span.begin, result->span.end - result->span.begin));
  const auto begin = static_cast<std::uint32_t>(words.data() - source.data());
  result->words = {result->span.source, begin, begin + static_cast<std::uint32_t>(words.size())};
  return result;
}

}  // namespace dmvv::voml
