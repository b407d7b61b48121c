// XML files in the encodings that editors write: the same scene, places exact; contradictions; what is refused.
#include "base/encoding.h"

#include <doctest/doctest.h>

#include <cstdint>

#include "voml/assets/grid.h"
#include "voml/format.h"
#include "voml/scene.h"

using namespace dmvv;
using namespace dmvv::voml;

namespace {

/// Code points in an encoding of fixed rules, written here after the Unicode standard and ISO 8859.
std::string encode(std::u32string_view text, const std::string& encoding) {
  std::string bytes;
  const auto unit = [&](std::uint32_t value, int size, bool big) {
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> 8 * (big ? size - 1 - i : i));
  };
  for (const char32_t c : text) {
    if (encoding == "UTF-32LE" || encoding == "UTF-32BE") {
      unit(c, 4, encoding.ends_with("BE"));
    } else if (encoding == "UTF-16LE" || encoding == "UTF-16BE") {
      const bool big = encoding.ends_with("BE");
      if (c < 0x10000) {
        unit(c, 2, big);
      } else {
        unit(0xd800 + ((c - 0x10000) >> 10), 2, big);
        unit(0xdc00 + ((c - 0x10000) & 0x3ff), 2, big);
      }
    } else if (encoding == "UTF-8") {
      if (c < 0x80) {
        bytes += static_cast<char>(c);
      } else if (c < 0x800) {
        bytes += static_cast<char>(0xc0 | c >> 6), bytes += static_cast<char>(0x80 | (c & 0x3f));
      } else if (c < 0x10000) {
        bytes += static_cast<char>(0xe0 | c >> 12), bytes += static_cast<char>(0x80 | (c >> 6 & 0x3f)),
            bytes += static_cast<char>(0x80 | (c & 0x3f));
      } else {
        bytes += static_cast<char>(0xf0 | c >> 18), bytes += static_cast<char>(0x80 | (c >> 12 & 0x3f)),
            bytes += static_cast<char>(0x80 | (c >> 6 & 0x3f)), bytes += static_cast<char>(0x80 | (c & 0x3f));
      }
    } else {  // ISO-8859-1, and of ISO-8859-15 and windows-1252 the euro sign
      const char euro = encoding == "ISO-8859-15" ? '\xa4' : '\x80';
      bytes += c == U'€' ? euro : static_cast<char>(c);
    }
  }
  return bytes;
}

std::u32string scene(std::u32string_view declaration, std::u32string_view name) {
  return std::u32string(declaration) + U"<MVV>\n<OBJECT name='" + std::u32string(name) +
         U"'><REGION name='R' type='empty'/></OBJECT>\n</MVV>\n";
}

std::u32string declared(std::string_view encoding) {
  return U"<?xml version='1.0' encoding='" + std::u32string(encoding.begin(), encoding.end()) + U"'?>\n";
}

struct Read {
  std::optional<Scene> scene;
  Diagnostics diagnostics;
};
Read read(const std::string& bytes) {
  Read result;
  result.scene = read_scene("s.voml", memory_files({{"s.voml", bytes}}), {}, result.diagnostics);
  return result;
}

void check_name(const std::string& bytes, std::u32string_view name) {
  const Read result = read(bytes);
  CHECK(result.diagnostics.render() == "");
  REQUIRE(result.scene);
  CHECK(result.scene->objects.back().name == encode(name, "UTF-8"));
}

std::string first_line(const Diagnostics& diagnostics) {
  const std::string all = diagnostics.render();
  return all.substr(0, all.find('\n'));
}

}  // namespace

TEST_CASE("what the declaration, the mark or the first bytes say is converted") {
  const std::u32string_view wide = U"Zitrusschäle €\U0001f34a", latin = U"Zitrusschäle", euro = U"Schäle €";
  const std::u32string mark = U"\ufeff";
  for (const std::string encoding : {"UTF-16LE", "UTF-16BE", "UTF-32LE", "UTF-32BE"}) {
    CAPTURE(encoding);
    const std::string family = encoding.substr(0, 6);
    check_name(encode(mark + scene(declared(family), wide), encoding), wide);
    check_name(encode(mark + scene(U"", wide), encoding), wide);
    check_name(encode(scene(declared(family), wide), encoding), wide);
    check_name(encode(scene(U"", wide), encoding), wide);
    check_name(encode(scene(declared(encoding), wide), encoding), wide);
  }
  check_name(encode(scene(declared("UTF-8"), wide), "UTF-8"), wide);
  check_name(encode(mark + scene(declared("utf-8"), wide), "UTF-8"), wide);
  check_name(encode(scene(U"", wide), "UTF-8"), wide);
  check_name(encode(scene(declared("ISO-8859-1"), latin), "ISO-8859-1"), latin);
  check_name(encode(scene(declared("latin1"), latin), "ISO-8859-1"), latin);
  check_name(encode(scene(declared("windows-1252"), euro), "windows-1252"), euro);
  check_name(encode(scene(declared("ISO-8859-15"), euro), "ISO-8859-15"), euro);
  check_name(encode(scene(declared("US-ASCII"), U"peel"), "ISO-8859-1"), U"peel");
  // Shift-JIS: 0x82 0xa0 is HIRAGANA LETTER A (JIS X 0208 row 4).
  std::string shift_jis = encode(scene(declared("Shift_JIS"), U"@"), "ISO-8859-1");
  check_name(shift_jis.replace(shift_jis.find('@'), 1, "\x82\xa0"), U"\u3042");
}

TEST_CASE("columns count characters, whatever the encoding") {
  for (const std::string encoding : {"UTF-8", "UTF-16LE", "UTF-16BE", "UTF-32LE", "ISO-8859-1"}) {
    CAPTURE(encoding);
    const std::u32string text =
        declared(encoding) + U"<MVV>\n<OBJECT name='äöü'><REGION nam='R' type='empty'/></OBJECT></MVV>";
    CHECK(first_line(read(encode(text, encoding)).diagnostics).starts_with("s.voml:3:28: error[E0201]"));
  }
}

TEST_CASE("a declaration that the bytes contradict: the bytes decide, with a warning") {
  const auto check = [](const std::string& bytes, const std::string& message) {
    const Read result = read(bytes);
    REQUIRE(result.scene);
    CHECK(first_line(result.diagnostics) == message);
    CHECK(result.scene->objects.back().name == "\xc3\xa4");
  };
  check(encode(scene(declared("UTF-16"), U"ä"), "UTF-8"),
        "s.voml:1:31: warning[W0010]: the declaration says 'UTF-16', but the file is UTF-8, and is read as that");
  check(encode(scene(declared("utf-8"), U"ä"), "UTF-16LE"),
        "s.voml:1:31: warning[W0010]: the declaration says 'utf-8', but the file is UTF-16LE, and is read as that");
  check("\xef\xbb\xbf" + encode(scene(declared("ISO-8859-1"), U"ä"), "UTF-8"),
        "s.voml:1:31: warning[W0010]: the declaration says 'ISO-8859-1', but the file is UTF-8, and is read as that");
  check(encode(scene(declared("UTF-16BE"), U"ä"), "UTF-16LE"),
        "s.voml:1:31: warning[W0010]: the declaration says 'UTF-16BE', but the file is UTF-16LE, and is read as that");
}

TEST_CASE("bytes that mean nothing are refused where they stand") {
  const auto refused = [](const std::string& bytes) {
    const Read result = read(bytes);
    CHECK_FALSE(result.scene);
    CHECK(result.diagnostics.all().size() == 1);
    return first_line(result.diagnostics);
  };
  const std::string way_out =
      "; save the file as UTF-8, or let it begin with what it is: <?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>";
  CHECK(refused("<MVV>\n<!-- \xc3\xa4 \xe9 -->\n<OBJECT/></MVV>") ==
        "s.voml:2:8: error[E0003]: the byte e9 is not UTF-8" + way_out);
  CHECK(refused(encode(scene(declared("UTF-8"), U"ä"), "ISO-8859-1")) ==
        "s.voml:3:15: error[E0003]: the byte e4 is not UTF-8" + way_out);
  CHECK(refused(encode(scene(declared("US-ASCII"), U"ä"), "ISO-8859-1")) ==
        "s.voml:3:15: error[E0003]: the byte e4 means nothing in US-ASCII");
  CHECK(refused(encode(scene(declared("windows-1252"), U"\u0081"), "ISO-8859-1")) ==
        "s.voml:3:15: error[E0003]: the byte 81 means nothing in windows-1252");
  const std::string lone = std::string("\xff\xfe<\0M\0\n\0<\0\0\xd8>\0", 14);
  CHECK(refused(lone) == "s.voml:2:2: error[E0003]: the bytes 00 d8 mean nothing in UTF-16LE");
  CHECK(refused(std::string("\xfe\xff\0<\0M\0", 7)) ==
        "s.voml:1:3: error[E0003]: the file ends within a character of UTF-16BE");
  CHECK(refused(encode(scene(declared("UTF-16"), U"ä"), "ISO-8859-1")) ==
        "s.voml:3:15: error[E0003]: the byte e4 is not UTF-8" + way_out);
  CHECK(refused(encode(scene(declared("klingon"), U"a"), "UTF-8")) ==
        "s.voml:1:31: error[E0010]: the encoding 'klingon' is not known; save the file as UTF-8");
  // What iconv understands beside names of encodings is none.
  CHECK(refused(encode(scene(declared("UTF-8//IGNORE"), U"a"), "UTF-8")).starts_with("s.voml:1:31: error[E0010]"));
}

TEST_CASE("UTF-8 is what Unicode's table 3-7 says") {
  const auto fault = [](std::string_view bytes) { return first_not_utf8(bytes); };
  CHECK_FALSE(
      fault("a\xc2\x80\xdf\xbf\xe0\xa0\x80\xed\x9f\xbf\xee\x80\x80\xef\xbf\xbf\xf0\x90\x80\x80\xf4\x8f\xbf\xbf"));
  for (const std::string_view wrong :
       {"\x80", "\xbf", "\xc0\x80", "\xc1\xbf", "\xc2", "\xc2\x41", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xe1\x80",
        "\xe1\x80\x41", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"}) {
    CHECK(fault(std::string("ab") + std::string(wrong)) == 2u);
  }
}

TEST_CASE("a layout is UTF-8, and says so") {
  const auto formatted = [](const std::string& bytes) {
    Diagnostics diagnostics;
    const auto result = format_document(diagnostics.add_source("s.voml", bytes), diagnostics);
    REQUIRE_MESSAGE(result, diagnostics.render());
    return *result;
  };
  const auto expected = [](const std::string& head) {
    return head + "<MVV>\n  <OBJECT name=\"\xc3\xa4\"><REGION name=\"R\" type=\"empty\"/></OBJECT>\n</MVV>\n";
  };
  const std::string said = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  CHECK(formatted(encode(scene(declared("ISO-8859-1"), U"ä"), "ISO-8859-1")) == expected(said));
  CHECK(formatted(encode(U"\ufeff" + scene(declared("UTF-16"), U"ä"), "UTF-16LE")) == expected(said));
  CHECK(formatted(encode(scene(U"", U"ä"), "UTF-16BE")) == expected(""));
  CHECK(formatted(encode(scene(declared("UTF-16"), U"ä"), "UTF-8")) == expected(said));
  CHECK(formatted(encode(scene(declared("utf-8"), U"ä"), "UTF-8")) ==
        expected("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"));
}

TEST_CASE("lists of numbers in UTF-16") {
  Diagnostics diagnostics;
  const std::string bytes = encode(U"\ufeff# Plätze\r\n0.5 0 1\r\n", "UTF-16LE");
  const auto vectors = parse_vectors(diagnostics.add_source("seeds.txt", bytes), diagnostics);
  REQUIRE_MESSAGE(vectors, diagnostics.render());
  CHECK(*vectors == std::vector<glm::dvec3>{{0.5, 0, 1}});
}
