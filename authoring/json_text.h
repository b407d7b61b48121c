// Private to authoring: JSON whose values have places in their text.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

namespace dmvv::authoring {

using Json = nlohmann::ordered_json;

/// Bytes [begin, end) of a text.
struct JsonPlace {
  std::size_t begin;
  std::size_t end;
};

/// Where a text breaks the rules of JSON, and how.
struct JsonFault {
  JsonPlace place;
  const char* why;
};

/// The values of a text; of keys that stand twice in an object the last counts. Otherwise `fault` says where it is
/// none.
std::optional<Json> parse_json(std::string_view text, JsonFault& fault);

/// Where a value of `root` stands in the text from which that was parsed; of an object or list its opening bracket.
/// Cost: linear in the text; values need not remember their places.
JsonPlace place_of(const Json& value, const Json& root, std::string_view text);

}  // namespace dmvv::authoring
