#include "voml/format.h"

#include <algorithm>
#include <cstdint>
#include <pugixml.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "base/limits.h"
#include "base/text.h"
#include "voml/attributes.h"
#include "voml/xml_document.h"

namespace dmvv::voml {
namespace {

constexpr std::size_t line_width = 120;
constexpr std::size_t deepest_indented_level = 40;  // bounds the output of deep trees

/// Line ends as XML reads them; without a byte order mark.
std::string normal_text(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
    result += text[i] == '\r' ? '\n' : text[i];
  }
  return result;
}

/// A document whose nodes hold the bytes as they are written: entities, line ends and blanks between elements too.
class Layout {
 public:
  explicit Layout(std::string text) : text_(std::move(text)), buffer_(text_) {
    for (std::size_t i = text_.find('\n'); i != std::string::npos; i = text_.find('\n', i + 1)) line_ends_.push_back(i);
  }

  pugi::xml_parse_result parse() {
    constexpr unsigned raw = pugi::parse_cdata | pugi::parse_comments | pugi::parse_pi | pugi::parse_declaration |
                             pugi::parse_doctype | pugi::parse_ws_pcdata | pugi::parse_fragment;
    return document_.load_buffer_inplace(buffer_.data(), buffer_.size(), raw, pugi::encoding_utf8);
  }

  /// Without recursion, as trees may be thousands of elements deep.
  std::string print() {
    open_.push_back({document_, core_of(document_), document_.first_child()});
    while (!open_.empty()) {
      Open& open = open_.back();
      if (open.next) {
        const pugi::xml_node child = open.next;
        open.next = child.next_sibling();
        print_child(open, child);
      } else {
        finish(open);
        open_.pop_back();
      }
    }
    out_.erase(0, out_.find_first_not_of('\n'));
    return std::move(out_) + '\n';
  }

 private:
  struct Bytes {
    std::size_t begin;
    std::size_t end;
  };

  std::size_t offset(const char* p) const { return static_cast<std::size_t>(p - buffer_.data()); }

  /// Of a name or value, which ends with the zero that pugixml puts there.
  Bytes bytes(const char* p) const { return {offset(p), offset(p) + std::string_view(p).size()}; }

  /// Of a text or CDATA node with its marks.
  Bytes text_bytes(pugi::xml_node node) const {
    const Bytes value = bytes(node.value());
    return node.type() == pugi::node_cdata ? Bytes{value.begin - 9, value.end + 3} : value;
  }

  std::string_view written(Bytes b) const { return std::string_view(text_).substr(b.begin, b.end - b.begin); }

  static bool is_space(pugi::xml_node node) { return node.type() == pugi::node_pcdata && trim(node.value()).empty(); }
  static bool is_text(pugi::xml_node node) {
    return node.type() == pugi::node_cdata || (node.type() == pugi::node_pcdata && !is_space(node));
  }

  /// The texts of an element, and whatever stands between the first and the last: it stays as it is written.
  struct Core {
    pugi::xml_node first, last;
  };
  static Core core_of(pugi::xml_node parent) {
    Core core;
    for (const pugi::xml_node child : parent.children()) {
      if (!is_text(child)) continue;
      if (!core.first) core.first = child;
      core.last = child;
    }
    return core;
  }
  std::string_view written(const Core& core) const {
    return written({text_bytes(core.first).begin, text_bytes(core.last).end});
  }

  bool has_line_end(Bytes b) const {
    const auto next = std::lower_bound(line_ends_.begin(), line_ends_.end(), b.begin);
    return next != line_ends_.end() && *next < b.end;
  }

  // ---- tags ----

  struct Attribute {
    std::size_t rank;
    std::string text;
  };

  /// In canonical order and spelling; of equal names the first stays first.
  std::vector<std::string> attributes(pugi::xml_node element, Tag tag) const {
    const auto known = attributes_of(tag);
    std::vector<Attribute> found;
    for (const pugi::xml_attribute attribute : element.attributes()) {
      const auto slot = std::ranges::find_if(known, [&](auto name) { return same_word(name, attribute.name()); });
      const Bytes value = bytes(attribute.value());
      if (element.type() == pugi::node_declaration && same_word(attribute.name(), "encoding") &&
          !is_true_encoding(written(value))) {
        found.push_back({known.size(), "encoding=\"UTF-8\""});
        continue;
      }
      const char quote = written(value).find('"') == std::string_view::npos ? '"' : '\'';
      found.push_back({static_cast<std::size_t>(slot - known.begin()),
                       std::string(slot == known.end() ? std::string_view(attribute.name()) : *slot) + '=' + quote +
                           std::string(written(value)) + quote});
    }
    std::ranges::stable_sort(found, {}, &Attribute::rank);
    std::vector<std::string> result;
    for (Attribute& attribute : found) result.push_back(std::move(attribute.text));
    return result;
  }

  /// Of a layout, which is UTF-8: another encoding that the file had is no longer true.
  static bool is_true_encoding(std::string_view declared) {
    const bool is_ascii = same_word(declared, "US-ASCII") || same_word(declared, "ASCII");
    return is_ascii || same_word(declared, "UTF-8") || same_word(declared, "UTF8");
  }

  static Tag tag_of_element(pugi::xml_node element) {
    return element.type() == pugi::node_element ? tag_of(element.name()) : Tag::unknown;
  }
  /// Spelt as the specification spells it; MMV and MV stay.
  static std::string name_of_element(pugi::xml_node element) {
    const Tag tag = tag_of_element(element);
    const bool known = tag != Tag::unknown && same_word(name_of(tag), element.name());
    return known ? std::string(name_of(tag)) : element.name();
  }

  /// "<NAME a="1" b="2"" without its end, which takes `end_width` columns more; wrapped under the first attribute.
  void print_tag(pugi::xml_node element, std::string_view mark, std::size_t column, std::size_t end_width) {
    const std::string name = std::string(mark) + name_of_element(element);
    const std::vector<std::string> words = attributes(element, tag_of_element(element));
    const std::size_t first_column = column + name.size() + 1;
    out_ += name;
    std::size_t at = column + name.size();
    for (std::size_t i = 0; i < words.size(); ++i) {
      const std::size_t end = words[i].size() + (i + 1 == words.size() ? end_width : 0);
      if (i != 0 && at + 1 + end > line_width) {
        out_ += '\n' + std::string(first_column, ' ');
        at = first_column;
      } else {
        out_ += ' ';
        ++at;
      }
      out_ += words[i];
      at += words[i].size();
    }
  }

  // ---- elements on one line ----

  /// Where the last thing in a node ends, its closing tag left aside.
  std::size_t end_of_content(pugi::xml_node node) const {
    while (node.last_child()) node = node.last_child();
    if (node.type() != pugi::node_element) return bytes(node.value()).end;
    return bytes(node.last_attribute() ? node.last_attribute().value() : node.name()).end;
  }

  /// Appends the element without a line end or comment, and fails where it becomes too long.
  bool append_flat(pugi::xml_node element, std::size_t room, std::string& flat) const {
    flat += '<' + name_of_element(element);
    for (const std::string& attribute : attributes(element, tag_of_element(element))) flat += ' ' + attribute;
    const Core core = core_of(element);
    bool any = false;
    for (pugi::xml_node child = element.first_child(); child; child = child.next_sibling()) {
      if (flat.size() > room) return false;
      if (is_space(child)) continue;
      if (!any) flat += '>';
      any = true;
      if (child == core.first) {
        flat += written(core);
        child = core.last;
      } else if (child.type() != pugi::node_element || !append_flat(child, room, flat)) {
        return false;
      }
    }
    flat += any ? "</" + name_of_element(element) + '>' : "/>";
    return flat.size() <= room;
  }

  /// The element on one line, if its author wrote it so and it fits.
  bool print_flat(pugi::xml_node element, std::size_t column) {
    std::string flat;  // first: what fits has few parts, so looking for its end costs little
    if (!append_flat(element, line_width - column, flat)) return false;
    if (has_line_end({offset(element.name()), end_of_content(element)})) return false;
    out_ += flat;
    return true;
  }

  // ---- elements on several lines ----

  /// False if that was all of the element.
  bool open_element(pugi::xml_node element, std::size_t column) {
    if (print_flat(element, column)) return false;
    const auto children = element.children();
    const bool empty = std::all_of(children.begin(), children.end(), is_space);
    print_tag(element, "<", column, empty ? 2 : 1);
    out_ += empty ? "/>" : ">";
    return !empty;
  }
  void close_element(pugi::xml_node element) { out_ += "</" + name_of_element(element) + '>'; }

  static std::size_t indentation(std::size_t level) { return 2 * std::min(level, deepest_indented_level); }
  void new_line(std::size_t level) { out_ += '\n' + std::string(indentation(level), ' '); }

  /// The element, or document, whose children are being printed.
  struct Open {
    pugi::xml_node parent;
    Core core;
    pugi::xml_node next;
    std::size_t line_ends = 0;  // since the last child
    bool after_text = false;
    bool before_any = true;
    bool on_own_line = true;  // the closing tag
  };

  /// A child on a line of its own, but for what adjoins a text, and for comments that stand behind something.
  void print_child(Open& open, pugi::xml_node child) {
    const std::size_t level = open_.size() - 1;
    if (is_space(child)) {
      open.line_ends += static_cast<std::size_t>(std::ranges::count(std::string_view(child.value()), '\n'));
      return;
    }
    const std::size_t line_ends = std::exchange(open.line_ends, 0);
    const bool before_any = std::exchange(open.before_any, false);
    const bool after_text = std::exchange(open.after_text, false);
    if (child == open.core.first) {
      // Blanks before a CDATA section are no text; those before other text are part of it.
      if (!before_any && child.type() == pugi::node_cdata) separate(line_ends, level);
      out_ += written(open.core);
      open.after_text = open.core.last.type() == pugi::node_pcdata;
      open.on_own_line = false;
      open.next = open.core.last.next_sibling();
      return;
    }
    open.on_own_line = true;
    const bool stays = child.type() == pugi::node_comment && line_ends == 0 &&
                       open.parent.type() == pugi::node_element && !has_line_end(bytes(child.value()));
    if (stays && !after_text) out_ += ' ';
    if (!stays && !after_text) separate(line_ends, level);
    if (child.type() != pugi::node_element) return print_leaf(child);
    if (open_element(child, indentation(level))) open_.push_back({child, core_of(child), child.first_child()});
  }

  void finish(const Open& open) {
    if (open.parent.type() != pugi::node_element) return;
    if (open.on_own_line && open.line_ends > 1) out_ += '\n';
    if (open.on_own_line) new_line(open_.size() - 2);
    close_element(open.parent);
  }

  /// The next node stands on a line of its own, below an empty one if its author left one.
  void separate(std::size_t line_ends, std::size_t level) {
    if (line_ends > 1) out_ += '\n';
    new_line(level);
  }

  void print_leaf(pugi::xml_node node) {
    switch (node.type()) {
      case pugi::node_comment:
        return print_comment(node);
      case pugi::node_declaration:
        print_tag(node, "<?", 0, 2);
        out_ += "?>";
        return;
      case pugi::node_pi:
        out_ += std::string("<?") + node.name() + (*node.value() ? " " : "") + node.value() + "?>";
        return;
      case pugi::node_doctype:
        out_ += std::string("<!DOCTYPE ") + node.value() + '>';
        return;
      default:
        return;
    }
  }

  std::size_t column_of(std::size_t at) const {
    const auto next = std::lower_bound(line_ends_.begin(), line_ends_.end(), at);
    return next == line_ends_.begin() ? at : at - *(next - 1) - 1;
  }

  /// The further lines of a comment move as far as its first, but not beyond the left border.
  void print_comment(pugi::xml_node comment) {
    const std::string_view value = written(bytes(comment.value()));
    const std::size_t line_begin = out_.rfind('\n') + 1;  // npos + 1 is 0
    const std::size_t from = column_of(offset(comment.value()) - 4), to = out_.size() - line_begin;
    std::vector<std::string_view> lines;
    for (std::size_t begin = 0; begin <= value.size();) {
      const std::size_t end = std::min(value.find('\n', begin), value.size());
      lines.push_back(value.substr(begin, end - begin));
      begin = end + 1;
    }
    std::size_t room = from > to ? from - to : 0;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const bool last = i + 1 == lines.size();  // its blanks stand before "-->"
      const std::size_t blanks = lines[i].find_first_not_of(" \t");
      if (blanks != std::string_view::npos || last) room = std::min(room, std::min(blanks, lines[i].size()));
    }
    out_ += "<!--";
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const bool blank = trim(lines[i]).empty() && i + 1 != lines.size();
      if (i != 0) out_ += '\n';
      if (i != 0 && !blank && to > from) out_ += std::string(to - from, ' ');
      out_ += i != 0 && !blank ? lines[i].substr(room) : lines[i];
    }
    out_ += "-->";
  }

  std::string text_;
  std::string buffer_;  // pugixml parses in place
  pugi::xml_document document_;
  std::vector<std::size_t> line_ends_;
  std::vector<Open> open_;
  std::string out_;
};

}  // namespace

std::optional<std::string> format_document(SourceId source, Diagnostics& diagnostics) {
  std::size_t elements_left = max_elements;
  const auto document = XmlDocument::parse(source, elements_left, diagnostics);
  if (!document || !check_root({document.get(), document->root()}, diagnostics)) return std::nullopt;
  if (diagnostics.has_errors()) return std::nullopt;
  // Reading passes over declarations and processing instructions, whatever is in them.
  if (const auto parsed = Layout(diagnostics.source_text(source)).parse(); !parsed) {
    const auto at = static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(parsed.offset, 0));
    diagnostics.report(Code::malformed_xml, {source, at, at}, std::string(what_went_wrong(parsed.status)));
    return std::nullopt;
  }
  Layout layout(normal_text(diagnostics.source_text(source)));
  layout.parse();
  return layout.print();
}

}  // namespace dmvv::voml
