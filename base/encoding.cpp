#include "base/encoding.h"

#include <fmt/format.h>
#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "base/limits.h"
#include "base/text.h"

namespace dmvv {

// ---- UTF-8 ----

namespace {

unsigned char byte(char c) { return static_cast<unsigned char>(c); }

/// What may follow the first byte of a character: how many bytes, and the range of the next one.
struct Sequence {
  std::size_t length = 0;  ///< 0: no character begins so
  unsigned char least = 0x80, most = 0xbf;
};

Sequence sequence_of(unsigned char first) {
  if (first < 0x80) return {1};
  if (first < 0xc2) return {};
  if (first < 0xe0) return {2};
  if (first == 0xe0) return {3, 0xa0};
  if (first == 0xed) return {3, 0x80, 0x9f};
  if (first < 0xf0) return {3};
  if (first == 0xf0) return {4, 0x90};
  if (first < 0xf4) return {4};
  if (first == 0xf4) return {4, 0x80, 0x8f};
  return {};
}

}  // namespace

std::optional<std::size_t> first_not_utf8(std::string_view bytes) {
  for (std::size_t i = 0; i < bytes.size();) {
    const Sequence sequence = sequence_of(byte(bytes[i]));
    if (sequence.length == 0 || sequence.length > bytes.size() - i) return i;
    for (std::size_t k = 1; k < sequence.length; ++k) {
      const unsigned char next = byte(bytes[i + k]);
      const bool fits = k == 1 ? next >= sequence.least && next <= sequence.most : next >= 0x80 && next <= 0xbf;
      if (!fits) return i;
    }
    i += sequence.length;
  }
  return std::nullopt;
}

// ---- other encodings ----

std::string_view encoding_of_mark(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) return "UTF-8";
  if (bytes.starts_with(std::string_view("\xff\xfe\0\0", 4))) return "UTF-32LE";
  if (bytes.starts_with(std::string_view("\0\0\xfe\xff", 4))) return "UTF-32BE";
  if (bytes.starts_with("\xff\xfe")) return "UTF-16LE";
  if (bytes.starts_with("\xfe\xff")) return "UTF-16BE";
  return {};
}

namespace {

/// A conversion of iconv's.
class Converter {
 public:
  explicit Converter(const std::string& encoding) : handle_(iconv_open("UTF-8", encoding.c_str())) {}
  Converter(const Converter&) = delete;
  Converter& operator=(const Converter&) = delete;
  ~Converter() {
    if (known()) iconv_close(handle_);
  }

  bool known() const { return handle_ != reinterpret_cast<iconv_t>(-1); }

  /// Appends what `rest` stands for and takes it away as far as it can be converted; 0, or errno.
  int convert(std::string_view& rest, std::string& text) {
    std::array<char, std::size_t{1} << 14> room;
    for (;;) {
      char* from = const_cast<char*>(rest.data());  // iconv does not write there
      std::size_t left = rest.size();
      char* to = room.data();
      std::size_t free = room.size();
      // The last call, without input, writes what a stateful encoding still holds.
      const bool last = left == 0;
      const std::size_t result = iconv(handle_, last ? nullptr : &from, &left, &to, &free);
      const int error = result == static_cast<std::size_t>(-1) ? errno : 0;
      text.append(room.data(), room.size() - free);
      rest.remove_prefix(rest.size() - left);
      if (error != 0 && error != E2BIG) return error;
      if (last && error == 0) return 0;
    }
  }

 private:
  iconv_t handle_;
};

/// As XML writes the names of encodings. What iconv adds to names ("//IGNORE") must not come from a file.
bool is_encoding_name(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto may_follow = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= 64 && is_letter(name[0]) && std::ranges::all_of(name, may_follow);
}

std::string hexadecimal(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) text += fmt::format(" {:02x}", byte(c));
  return text;
}

std::string meaningless(std::string_view bytes, std::string_view encoding) {
  const std::size_t unit = encoding.starts_with("UTF-16") ? 2 : encoding.starts_with("UTF-32") ? 4 : 1;
  const std::string_view shown = bytes.substr(0, unit);
  return fmt::format("the byte{}{} mean{} nothing in {}", shown.size() == 1 ? "" : "s", hexadecimal(shown),
                     shown.size() == 1 ? "s" : "", encoding);
}

}  // namespace

std::optional<Decoded> decode(std::string_view bytes, std::string_view encoding) {
  if (!is_encoding_name(encoding)) return std::nullopt;
  Converter converter{std::string(encoding)};
  if (!converter.known()) return std::nullopt;
  Decoded decoded;
  std::string_view rest = bytes;
  const int error = converter.convert(rest, decoded.text);
  if (error == EINVAL) {
    decoded.fault = fmt::format("the file ends within a character of {}", encoding);
  } else if (error != 0) {
    decoded.fault = meaningless(rest, encoding);
  }
  return decoded;
}

namespace {

/// Puts the converted text in the place of the bytes; a fault is reported where it is.
bool convert(SourceId source, std::string_view encoding, Diagnostics& diagnostics) {
  auto decoded = decode(diagnostics.source_text(source), encoding).value();
  if (decoded.text.size() > max_file_bytes) decoded = {{}, "as UTF-8 the text is longer than 4 GiB"};
  const auto end = static_cast<std::uint32_t>(decoded.text.size());
  diagnostics.replace_source_text(source, std::move(decoded.text));
  if (decoded.fault.empty()) return true;
  diagnostics.report(Code::not_utf8_text, {source, end, end}, std::move(decoded.fault));
  return false;
}

}  // namespace

bool make_utf8_by_mark(SourceId source, Diagnostics& diagnostics) {
  const std::string_view encoding = encoding_of_mark(diagnostics.source_text(source));
  return encoding.empty() || encoding == "UTF-8" || convert(source, encoding, diagnostics);
}

// ---- XML ----

namespace {

/// UTF-16 and UTF-32 by how the first "<" is written.
std::string_view encoding_of_first_tag(std::string_view bytes) {
  const auto begins = [&](std::string_view pattern) { return bytes.starts_with(pattern); };
  if (begins(std::string_view("<\0\0\0", 4))) return "UTF-32LE";
  if (begins(std::string_view("\0\0\0<", 4))) return "UTF-32BE";
  if (begins(std::string_view("<\0", 2)) && bytes.size() >= 4 && bytes[3] == '\0') return "UTF-16LE";
  if (begins(std::string_view("\0<\0", 3))) return "UTF-16BE";
  return {};
}

/// The value of `encoding` in the XML declaration that a text begins with; empty without one.
std::string_view declared_encoding(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (!text.starts_with("<?xml") || text.size() < 6 || !is_blank(text[5])) return {};
  const std::string_view declaration = text.substr(0, text.find("?>"));
  std::size_t at = declaration.find("encoding");
  if (at == std::string_view::npos || !is_blank(declaration[at - 1])) return {};
  at += std::string_view("encoding").size();
  const auto skip_blanks = [&] { at = std::min(declaration.find_first_not_of(" \t\r\n", at), declaration.size()); };
  skip_blanks();
  if (at == declaration.size() || declaration[at] != '=') return {};
  ++at;
  skip_blanks();
  if (at == declaration.size() || (declaration[at] != '"' && declaration[at] != '\'')) return {};
  const std::size_t end = declaration.find(declaration[at], at + 1);
  return end == std::string_view::npos ? std::string_view() : declaration.substr(at + 1, end - at - 1);
}

/// Whether a declaration names the encoding that the bytes show: "UTF-16" and "UCS-2" leave the order of bytes open.
bool names(std::string_view declared, std::string_view shown) {
  if (same_word(declared, shown)) return true;
  const bool two_bytes = shown.starts_with("UTF-16"), four_bytes = shown.starts_with("UTF-32");
  return (two_bytes &&
          (same_word(declared, "UTF-16") || same_word(declared, "UCS-2") || same_word(declared, "ISO-10646-UCS-2"))) ||
         (four_bytes &&
          (same_word(declared, "UTF-32") || same_word(declared, "UCS-4") || same_word(declared, "ISO-10646-UCS-4")));
}

class XmlText {
 public:
  XmlText(SourceId source, Diagnostics& diagnostics)
      : source_(source), diagnostics_(diagnostics), bytes_(diagnostics.source_text(source)) {}

  bool make_utf8() {
    std::string_view shown = encoding_of_mark(bytes_);
    if (shown.empty()) shown = encoding_of_first_tag(bytes_);
    if (!shown.empty() && shown != "UTF-8") return convert_shown(shown);
    const std::string_view declared = declared_encoding(bytes_);
    if (declared.empty() || same_word(declared, "UTF-8") || same_word(declared, "UTF8")) return check_utf8();
    const Span said = span_of(declared);
    const std::string name(declared);
    const auto declaration = decode(bytes_.substr(0, said.end), name);
    if (!declaration) {
      diagnostics_.report(Code::unknown_encoding, said,
                          fmt::format("the encoding {} is not known; save the file as UTF-8", in_quotes(name)));
      return false;
    }
    // Bytes that show their declaration as ASCII are in no encoding that would write it otherwise.
    const bool contradicted = shown == "UTF-8" || declaration->text != bytes_.substr(0, said.end);
    if (!contradicted) return convert(source_, name, diagnostics_);
    if (!check_utf8()) return false;
    warn(said, name, "UTF-8");
    return true;
  }

 private:
  Span span_of(std::string_view part) const {
    const auto begin = static_cast<std::uint32_t>(part.data() - bytes_.data());
    return {source_, begin, begin + static_cast<std::uint32_t>(part.size())};
  }

  void warn(Span declaration, std::string_view declared, std::string_view shown) {
    diagnostics_.report(
        Code::encoding_contradicted, declaration,
        fmt::format("the declaration says {}, but the file is {}, and is read as that", in_quotes(declared), shown));
  }

  /// Bytes whose order alone says what they are.
  bool convert_shown(std::string_view shown) {
    if (!convert(source_, shown, diagnostics_)) return false;
    const std::string& text = diagnostics_.source_text(source_);
    const std::string declared(declared_encoding(text));
    if (declared.empty() || names(declared, shown)) return true;
    const auto begin = static_cast<std::uint32_t>(declared_encoding(text).data() - text.data());
    warn({source_, begin, begin + static_cast<std::uint32_t>(declared.size())}, declared, shown);
    return true;
  }

  bool check_utf8() {
    const auto fault = first_not_utf8(bytes_);
    if (!fault) return true;
    const auto begin = static_cast<std::uint32_t>(*fault);
    diagnostics_.report(
        Code::not_utf8_text, {source_, begin, begin + 1},
        fmt::format("the byte {:02x} is not UTF-8; save the file as UTF-8, or let it begin with what it is: "
                    "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>",
                    byte(bytes_[*fault])));
    return false;
  }

  SourceId source_;
  Diagnostics& diagnostics_;
  std::string_view bytes_;  ///< as the file has them; no longer once the text is replaced
};

}  // namespace

bool make_utf8(SourceId source, Diagnostics& diagnostics) { return XmlText(source, diagnostics).make_utf8(); }

}  // namespace dmvv
