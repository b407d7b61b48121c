// spec/diagnostics.md is generated from the table of codes.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "voml/diagnostics.h"

using namespace dmvv;

TEST_CASE("spec/diagnostics.md lists every code with its explanation, in order") {
  std::ifstream stream(DMVV_SOURCE_DIR "/spec/diagnostics.md");
  const std::string spec{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t table = spec.find("| code | name | what it says |\n|---|---|---|\n");
  REQUIRE(table != std::string::npos);
  std::string expected = "| code | name | what it says |\n|---|---|---|\n";
  for (const CodeInfo& code : all_codes())
    expected += fmt::format("| {} | `{}` | {} |\n", code.number, code.name, code.explanation);
  const std::string found = spec.substr(table, expected.size());
  CHECK_MESSAGE(found == expected, "the table should read:\n" << expected);
}
