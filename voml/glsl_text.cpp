#include "voml/glsl_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace dmvv::voml {
namespace {

/// An entity: what it stands for (UTF-8), and how long it is as written; no length if it is none.
struct Entity {
  std::string value;
  std::size_t length = 0;
};

std::string utf8(std::uint32_t c) {
  const auto tail = [&](int shift) { return static_cast<char>(0x80u | ((c >> shift) & 0x3fu)); };
  if (c < 0x80) return {static_cast<char>(c)};
  if (c < 0x800) return {static_cast<char>(0xc0u | (c >> 6)), tail(0)};
  if (c < 0x10000) return {static_cast<char>(0xe0u | (c >> 12)), tail(6), tail(0)};
  return {static_cast<char>(0xf0u | (c >> 18)), tail(12), tail(6), tail(0)};
}

Entity entity_at(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> named = {
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  for (const auto& [name, value] : named) {
    if (text.starts_with(name)) return {{value}, name.size()};
  }
  if (!text.starts_with("&#")) return {};
  const bool hex = text.substr(2).starts_with("x");
  const char* const begin = text.data() + (hex ? 3 : 2);
  const char* const end = text.data() + text.size();
  std::uint32_t code = 0;
  const auto [rest, fault] = std::from_chars(begin, end, code, hex ? 16 : 10);
  if (fault != std::errc() || rest == end || *rest != ';' || code > 0x10ffff) return {};
  return {utf8(code), static_cast<std::size_t>(rest + 1 - text.data())};
}

/// Appends `run` as a piece of its own that comes from `span`.
void append_piece(GlslText& text, std::string_view run, Span span) {
  if (run.empty()) return;
  text.pieces.push_back({static_cast<std::uint32_t>(text.text.size()), span});
  text.text += run;
}

std::uint32_t length_of_run(const GlslText& text, std::size_t piece) {
  const std::size_t end = piece + 1 < text.pieces.size() ? text.pieces[piece + 1].begin : text.text.size();
  return static_cast<std::uint32_t>(end) - text.pieces[piece].begin;
}

/// The place of one byte of a text.
Span place_of(const GlslText& text, std::uint32_t offset) {
  const auto next = std::upper_bound(text.pieces.begin(), text.pieces.end(), offset,
                                     [](std::uint32_t value, const TextPiece& piece) { return value < piece.begin; });
  if (next == text.pieces.begin()) return {};  // a text without places
  const TextPiece& piece = *(next - 1);
  const auto index = static_cast<std::size_t>(next - 1 - text.pieces.begin());
  if (length_of_run(text, index) != piece.span.end - piece.span.begin) return piece.span;  // an entity
  const std::uint32_t begin = std::min(piece.span.begin + (offset - piece.begin), piece.span.end);
  return {piece.span.source, begin, std::min(begin + 1, piece.span.end)};
}

}  // namespace

void append_text(GlslText& text, std::string_view file, Span part, bool has_entities) {
  std::uint32_t run = part.begin;
  const auto flush = [&](std::uint32_t end) {
    append_piece(text, file.substr(run, end - run), {part.source, run, end});
    run = end;
  };
  for (std::uint32_t i = part.begin; i < part.end;) {
    if (file[i] == '\r') {  // CR LF or CR: the run ends with a LF in its place
      flush(i);
      const bool is_pair = i + 1 < part.end && file[i + 1] == '\n';
      append_piece(text, "\n", {part.source, i, i + 1});
      run = i += is_pair ? 2 : 1;
      continue;
    }
    const Entity entity = has_entities && file[i] == '&' ? entity_at(file.substr(i, part.end - i)) : Entity{};
    if (entity.length == 0) {
      ++i;
      continue;
    }
    flush(i);
    const auto end = i + static_cast<std::uint32_t>(entity.length);
    append_piece(text, entity.value, {part.source, i, end});
    run = i = end;
  }
  flush(part.end);
}

void append_line_ends(GlslText& text, std::string_view file, Span part) {
  const std::string_view left_out = file.substr(part.begin, part.end - part.begin);
  append_piece(text, std::string(static_cast<std::size_t>(std::count(left_out.begin(), left_out.end(), '\n')), '\n'),
               part);
}

Span locate(const GlslText& text, std::uint32_t begin, std::uint32_t end) {
  const Span first = place_of(text, begin);
  if (end <= begin) return {first.source, first.begin, first.begin};
  const Span last = place_of(text, end - 1);
  return {first.source, first.begin, std::max(first.begin, last.end)};
}

}  // namespace dmvv::voml
