#include "base/text.h"

#include <doctest/doctest.h>

using namespace dmvv;

namespace {

std::optional<glm::dvec3> vector(std::string_view text) {
  const auto result = parse_vector(text);
  return std::holds_alternative<glm::dvec3>(result) ? std::optional(std::get<glm::dvec3>(result)) : std::nullopt;
}

NumberFault fault(std::string_view text) { return std::get<NumberFault>(parse_vector(text)); }

}  // namespace

TEST_CASE("a vector is three numbers separated by blanks and/or commas") {
  const glm::dvec3 expected(1.0, -2.5, 300.0);
  for (const char* text : {"1 -2.5 300", "1,-2.5,300", " 1 , -2.5\t,\n300 ", "+1 -2.5e0 3E2", "1.0,-25e-1 300"}) {
    CAPTURE(text);
    CHECK(vector(text) == expected);
  }
  for (const char* text : {"", " ", "1", "1 2", "1 2 3 4", "1,,2,3", ",1 2 3", "1 2 3,", "1 2 x", "1 2 3x", "1-2 3",
                           "1;2;3", "0x1 2 3", "+-1 2 3", "1 2 3 ,4", "1 . 2"}) {
    CAPTURE(text);
    CHECK_FALSE(vector(text).has_value());
  }
}

TEST_CASE("numbers that float32 cannot hold are refused, those below its range are zero") {
  CHECK(fault("1 inf 0").kind == NumberFault::Kind::not_finite);
  CHECK(fault("1 nan 0").kind == NumberFault::Kind::not_finite);
  CHECK(fault("1 3.5e38 0").kind == NumberFault::Kind::not_finite);
  CHECK(fault("1 1e999 0").kind == NumberFault::Kind::not_finite);
  CHECK(vector("1 3.4e38 1e-999") == glm::dvec3(1.0, 3.4e38, 0.0));
}

TEST_CASE("a fault says which part of the text it means") {
  const NumberFault f = fault("1, two ,3");
  CHECK(f.begin == 3);
  CHECK(f.end == 6);
  CHECK(f.message == "'two' is not a number");
}

TEST_CASE("a single number") {
  CHECK(std::get<double>(parse_number(" -1.5e2 ")) == -150.0);
  for (const char* text : {"", " ", "1 2", "1,", "x"}) {
    CAPTURE(text);
    CHECK(std::holds_alternative<NumberFault>(parse_number(text)));
  }
}

TEST_CASE("scales: zero and what has no float32 inverse are unusable") {
  CHECK(usable_scale(1.0));
  CHECK(usable_scale(-1e-30));
  CHECK_FALSE(usable_scale(0.0));
  CHECK_FALSE(usable_scale(-0.0));
  CHECK_FALSE(usable_scale(1e-39));
}

TEST_CASE("words are compared without regard to case, quotes are cut between code points") {
  CHECK(same_word("seedFile", "SEEDfile"));
  CHECK_FALSE(same_word("seed", "seedFile"));
  CHECK(in_quotes("R") == "'R'");
  std::string long_name(79, 'a');
  long_name += "\xc3\xa4\xc3\xa4";
  CHECK(in_quotes(long_name) == "'" + std::string(79, 'a') + "...'");
}

TEST_CASE("long chains are shortened in the middle") {
  CHECK(shortened_chain({"A", "B", "A"}) == "A -> B -> A");
  const std::vector<std::string_view> chain(100, "X");
  CHECK(shortened_chain(chain) == "X -> X -> X -> X -> X -> X -> (88 more) -> X -> X -> X -> X -> X -> X");
}

TEST_CASE("commas in numbers, typographic minus signs and semicolons: the message says what to write") {
  const auto message = [](std::string_view text) { return fault(text).message; };
  const std::string point = " are not three numbers; decimal numbers have a point: write ";
  CHECK(message("0,5 0,5 0,5") == "'0,5 0,5 0,5'" + point + "'0.5 0.5 0.5'");
  CHECK(message("0,5, 0,5, -1,25e2") == "'0,5, 0,5, -1,25e2'" + point + "'0.5 0.5 -1.25e2'");
  CHECK(message("1,5 2 3") == "'1,5 2 3'" + point + "'1.5 2 3'");
  CHECK(message("0,5;1;2") == "'0,5;1;2'" + point + "'0.5 1 2'");
  CHECK(message("1;0;0") == "'1;0;0' are not three numbers; blanks part the numbers: write '1 0 0'");
  CHECK(message("\xe2\x88\x92"
                "1 0 0") ==
        "'\xe2\x88\x92"
        "1 0 0' are not three numbers; the minus is '-': write '-1 0 0'");
  CHECK(message("1 2 3 4") == "there are more than three numbers");
  CHECK(message("1 2 3,") == "there is no number beside this comma");
  CHECK(message("1e39 0 0") == "'1e39' is not a finite float32 number");
  CHECK(std::get<glm::dvec3>(parse_vector("0,5 1")) == glm::dvec3(0, 5, 1));  // commas part numbers as well
  CHECK(std::get<NumberFault>(parse_number("0,5")).message ==
        "'0,5' is not a number; decimal numbers have a point: write 0.5");
  CHECK(std::get<NumberFault>(parse_number("\xe2\x88\x92"
                                           "2"))
            .message ==
        "'\xe2\x88\x92"
        "2' is not a number; the minus is '-': write -2");
  CHECK(std::get<NumberFault>(parse_number("1,2,3")).message == "'1,2,3' is not a number");
}
