#include "base/diagnostics.h"

#include <doctest/doctest.h>

#include <set>

using namespace dmvv;

TEST_CASE("a diagnostic is rendered with its place, source line and caret") {
  Diagnostics diagnostics;
  const std::string text = "<MVV>\n  <REGION name=\"R.INTER\"/>\n</MVV>\n";
  const SourceId source = diagnostics.add_source("a.voml", text);
  const auto begin = static_cast<std::uint32_t>(text.find("R.INTER"));
  diagnostics.report(Code::unknown_name, {source, begin, begin + 7}, "unknown region 'R.INTER'",
                     {{{source, 0, 5}, "somewhere here"}, {{}, "no place"}});
  CHECK(diagnostics.render() ==
        "a.voml:2:17: error[E0103]: unknown region 'R.INTER'\n"
        "    2 |   <REGION name=\"R.INTER\"/>\n"
        "      |                 ^~~~~~~\n"
        "a.voml:1:1: note: somewhere here\n"
        "    1 | <MVV>\n"
        "      | ^~~~~\n"
        "note: no place\n"
        "1 error\n");
}

TEST_CASE("diagnostics come in the order of their places, those without a place first") {
  Diagnostics diagnostics;
  const SourceId a = diagnostics.add_source("a", "xy");
  const SourceId b = diagnostics.add_source("b", "");
  diagnostics.report(Code::cannot_read_file, {b, 0, 0}, "three");
  diagnostics.report(Code::cannot_read_file, {a, 1, 1}, "two");
  diagnostics.report(Code::unknown_element, {a, 0, 1}, "one");
  diagnostics.report(Code::cannot_read_file, {}, "zero");
  CHECK(diagnostics.render() ==
        "error[E0001]: zero\n"
        "a:1:1: warning[W0102]: one\n    1 | xy\n      | ^\n"
        "a:1:2: error[E0001]: two\n    1 | xy\n      |  ^\n"
        "b: error[E0001]: three\n"
        "3 errors, 1 warning\n");
}

TEST_CASE("lines end with LF, CR LF or CR; columns count code points; a byte order mark is no column") {
  Diagnostics diagnostics;
  const SourceId source = diagnostics.add_source("a",
                                                 "\xef\xbb\xbf"
                                                 "ab\r\n\xc3\xa4\xe2\x82\xac!\rx\ny");
  const auto place = [&](std::uint32_t offset) {
    const LineColumn at = diagnostics.locate(source, offset);
    return std::pair(at.line, at.column);
  };
  CHECK(place(0) == std::pair(1u, 1u));
  CHECK(place(3) == std::pair(1u, 1u));
  CHECK(place(4) == std::pair(1u, 2u));
  CHECK(place(7) == std::pair(2u, 1u));   // the two-byte letter
  CHECK(place(9) == std::pair(2u, 2u));   // the three-byte sign
  CHECK(place(12) == std::pair(2u, 3u));  // "!"
  CHECK(place(14) == std::pair(3u, 1u));
  CHECK(place(16) == std::pair(4u, 1u));
  CHECK(place(1000) == std::pair(4u, 2u));
}

TEST_CASE("tabs keep the caret in its place, control characters do not reach the terminal") {
  Diagnostics diagnostics;
  const SourceId source = diagnostics.add_source("a",
                                                 "\tab\t\x1b"
                                                 "c");
  diagnostics.report(Code::bad_number, {source, 5, 6}, "bell \a");
  CHECK(diagnostics.render() ==
        "a:1:6: error[E0204]: bell ?\n"
        "    1 | \tab\t?c\n"
        "      | \t  \t ^\n1 error\n");
}

TEST_CASE("a long line is cut around the caret") {
  Diagnostics diagnostics;
  const SourceId source = diagnostics.add_source("a", std::string(1000, '.') + "X" + std::string(1000, '.'));
  diagnostics.report(Code::bad_number, {source, 1000, 1001}, "here");
  const std::string rendered = diagnostics.render();
  CHECK(rendered.find("    1 | ..." + std::string(80, '.') + "X" + std::string(79, '.') + "...\n") !=
        std::string::npos);
  CHECK(rendered.find("      | " + std::string(83, ' ') + "^\n") != std::string::npos);
}

TEST_CASE("a span over several lines is marked to the end of its first") {
  Diagnostics diagnostics;
  const SourceId source = diagnostics.add_source("a", "one\ntwo\n");
  diagnostics.report(Code::stray_text, {source, 1, 6}, "text");
  CHECK(diagnostics.render() == "a:1:2: warning[W0105]: text\n    1 | one\n      |  ^~\n1 warning\n");
}

TEST_CASE("the cap counts what it does not show; the same code at the same span is said once") {
  Diagnostics diagnostics;
  const SourceId source = diagnostics.add_source("a", std::string(300, 'x'));
  for (std::uint32_t i = 0; i < 150; ++i) diagnostics.report(Code::bad_number, {source, i, i + 1}, "bad");
  for (std::uint32_t i = 0; i < 50; ++i) diagnostics.report(Code::bad_number, {source, i, i + 1}, "again");
  CHECK(diagnostics.all().size() == Diagnostics::cap);
  CHECK(diagnostics.error_count() == 150);
  CHECK(diagnostics.render().ends_with("\n150 errors; the first 100 are shown\n"));
}

TEST_CASE("strict makes errors of warnings; nothing reported renders to nothing") {
  Diagnostics lenient, strict(true);
  CHECK(lenient.render().empty());
  lenient.report(Code::unknown_element, {}, "x");
  strict.report(Code::unknown_element, {}, "x");
  CHECK_FALSE(lenient.has_errors());
  CHECK(lenient.warning_count() == 1);
  CHECK(strict.has_errors());
  CHECK(strict.render() == "error[W0102]: x\n1 error\n");
}

TEST_CASE("the nearest name is a plausible typo or nothing") {
  using Names = std::vector<std::string_view>;
  CHECK(nearest_name("R.INTER", Names{"R.SKIN", "R.INNER", "R.INNER_EMPTY"}) == "R.INNER");
  CHECK(nearest_name("flie", Names{"type", "file"}) == "file");          // a transposition counts one
  CHECK(nearest_name("ab", Names{"ba", "abc"}) == "ba");                 // a tie goes to the first
  CHECK(nearest_name("abcdef", Names{"abxxxx", "abcxyf"}) == "abcxyf");  // distance 2 of 6; 4 would be too far
  CHECK(nearest_name("R", Names{"Q"}) == "Q");                           // one edit is always near enough
  CHECK_FALSE(nearest_name("abc", Names{"xyz", ""}).has_value());
  CHECK_FALSE(nearest_name("anything", Names{}).has_value());
  CHECK_FALSE(nearest_name(std::string(100000, 'a'), Names{std::string_view("a")}).has_value());
}

TEST_CASE("the table is sorted and its numbers are unique and agree with the severities") {
  std::set<std::string_view> names;
  std::string_view last;
  for (const CodeInfo& code : all_codes()) {
    CAPTURE(code.number);
    CHECK(code.number > last);
    CHECK((code.number[0] == 'E') == (code.severity == Severity::error));
    CHECK(names.insert(code.name).second);
    CHECK(&info(code.code) == &code);
    last = code.number;
  }
}
