#include "compiler/snippet/built_ins.h"

#include <algorithm>
#include <array>
#include <unordered_map>

namespace dmvv::compiler::snippet {
namespace {

/// Result, name, parameters. F, I, U, B: scalar or vector of two to four, the same size throughout; V, IV, UV, BV:
/// vector; M: any matrix; S: square matrix; `>`: the function writes the parameter.
constexpr std::array table = {"F radians F",
                              "F degrees F",
                              "F sin F",
                              "F cos F",
                              "F tan F",
                              "F asin F",
                              "F acos F",
                              "F atan F F",
                              "F atan F",
                              "F sinh F",
                              "F cosh F",
                              "F tanh F",
                              "F asinh F",
                              "F acosh F",
                              "F atanh F",
                              "F pow F F",
                              "F exp F",
                              "F log F",
                              "F exp2 F",
                              "F log2 F",
                              "F sqrt F",
                              "F inversesqrt F",
                              "F abs F",
                              "I abs I",
                              "F sign F",
                              "I sign I",
                              "F floor F",
                              "F trunc F",
                              "F round F",
                              "F roundEven F",
                              "F ceil F",
                              "F fract F",
                              "F mod F float",
                              "F mod F F",
                              "F modf F >F",
                              "F min F F",
                              "F min F float",
                              "I min I I",
                              "I min I int",
                              "U min U U",
                              "U min U uint",
                              "F max F F",
                              "F max F float",
                              "I max I I",
                              "I max I int",
                              "U max U U",
                              "U max U uint",
                              "F clamp F F F",
                              "F clamp F float float",
                              "I clamp I I I",
                              "I clamp I int int",
                              "U clamp U U U",
                              "U clamp U uint uint",
                              "F mix F F F",
                              "F mix F F float",
                              "F mix F F B",
                              "I mix I I B",
                              "U mix U U B",
                              "B mix B B B",
                              "F step F F",
                              "F step float F",
                              "F smoothstep F F F",
                              "F smoothstep float float F",
                              "B isnan F",
                              "B isinf F",
                              "I floatBitsToInt F",
                              "U floatBitsToUint F",
                              "F intBitsToFloat I",
                              "F uintBitsToFloat U",
                              "F fma F F F",
                              "F frexp F >I",
                              "F ldexp F I",
                              "float length F",
                              "float distance F F",
                              "float dot F F",
                              "vec3 cross vec3 vec3",
                              "F normalize F",
                              "F faceforward F F F",
                              "F reflect F F",
                              "F refract F F float",
                              "M matrixCompMult M M",
                              "mat2 outerProduct vec2 vec2",
                              "mat3 outerProduct vec3 vec3",
                              "mat4 outerProduct vec4 vec4",
                              "mat2x3 outerProduct vec3 vec2",
                              "mat3x2 outerProduct vec2 vec3",
                              "mat2x4 outerProduct vec4 vec2",
                              "mat4x2 outerProduct vec2 vec4",
                              "mat3x4 outerProduct vec4 vec3",
                              "mat4x3 outerProduct vec3 vec4",
                              "mat2 transpose mat2",
                              "mat3 transpose mat3",
                              "mat4 transpose mat4",
                              "mat2x3 transpose mat3x2",
                              "mat3x2 transpose mat2x3",
                              "mat2x4 transpose mat4x2",
                              "mat4x2 transpose mat2x4",
                              "mat3x4 transpose mat4x3",
                              "mat4x3 transpose mat3x4",
                              "float determinant S",
                              "S inverse S",
                              "BV lessThan V V",
                              "BV lessThan IV IV",
                              "BV lessThan UV UV",
                              "BV lessThanEqual V V",
                              "BV lessThanEqual IV IV",
                              "BV lessThanEqual UV UV",
                              "BV greaterThan V V",
                              "BV greaterThan IV IV",
                              "BV greaterThan UV UV",
                              "BV greaterThanEqual V V",
                              "BV greaterThanEqual IV IV",
                              "BV greaterThanEqual UV UV",
                              "BV equal V V",
                              "BV equal IV IV",
                              "BV equal UV UV",
                              "BV equal BV BV",
                              "BV notEqual V V",
                              "BV notEqual IV IV",
                              "BV notEqual UV UV",
                              "BV notEqual BV BV",
                              "bool any BV",
                              "bool all BV",
                              "BV not BV",
                              "U uaddCarry U U >U",
                              "U usubBorrow U U >U",
                              "void umulExtended U U >U >U",
                              "void imulExtended I I >I >I",
                              "I bitfieldExtract I int int",
                              "U bitfieldExtract U int int",
                              "I bitfieldInsert I I int int",
                              "U bitfieldInsert U U int int",
                              "I bitfieldReverse I",
                              "U bitfieldReverse U",
                              "I bitCount I",
                              "I bitCount U",
                              "I findLSB I",
                              "I findLSB U",
                              "I findMSB I",
                              "I findMSB U",
                              "uint packUnorm2x16 vec2",
                              "uint packSnorm2x16 vec2",
                              "uint packUnorm4x8 vec4",
                              "uint packSnorm4x8 vec4",
                              "vec2 unpackUnorm2x16 uint",
                              "vec2 unpackSnorm2x16 uint",
                              "vec4 unpackUnorm4x8 uint",
                              "vec4 unpackSnorm4x8 uint",
                              "uint packHalf2x16 vec2",
                              "vec2 unpackHalf2x16 uint"};

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    words.emplace_back(line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return words;
}

/// What a word of the table stands for, one entry a size; a single one for what is a type by itself.
std::vector<std::string> types_of(const std::string& word) {
  static const std::unordered_map<std::string, std::vector<std::string>> families = {
      {"F", {"float", "vec2", "vec3", "vec4"}},
      {"I", {"int", "ivec2", "ivec3", "ivec4"}},
      {"U", {"uint", "uvec2", "uvec3", "uvec4"}},
      {"B", {"bool", "bvec2", "bvec3", "bvec4"}},
      {"V", {"vec2", "vec3", "vec4"}},
      {"IV", {"ivec2", "ivec3", "ivec4"}},
      {"UV", {"uvec2", "uvec3", "uvec4"}},
      {"BV", {"bvec2", "bvec3", "bvec4"}},
      {"S", {"mat2", "mat3", "mat4"}},
      {"M", {"mat2", "mat3", "mat4", "mat2x3", "mat2x4", "mat3x2", "mat3x4", "mat4x2", "mat4x3"}}};
  const auto found = families.find(word);
  return found == families.end() ? std::vector<std::string>{word} : found->second;
}

struct Library {
  std::vector<std::string> names;
  std::unordered_map<std::string, std::vector<BuiltIn>> overloads;
};

void add(Library& library, const BuiltIn& function) {
  std::vector<BuiltIn>& overloads = library.overloads[function.name];
  if (overloads.empty()) library.names.push_back(function.name);
  const bool is_known = std::any_of(overloads.begin(), overloads.end(),
                                    [&](const BuiltIn& other) { return other.signature() == function.signature(); });
  if (!is_known) overloads.push_back(function);  // `mod(float, float)` is in two lines of the table
}

Library read_table() {
  Library library;
  for (const char* const line : table) {
    const std::vector<std::string> words = words_of(line);
    std::vector<std::vector<std::string>> types;
    std::size_t sizes = 1;
    for (std::size_t i = 0; i < words.size(); ++i) {
      types.push_back(i == 1 ? words : types_of(words[i].substr(words[i][0] == '>' ? 1 : 0)));
      if (i != 1) sizes = std::max(sizes, types.back().size());
    }
    for (std::size_t size = 0; size < sizes; ++size) {
      const auto type = [&](std::size_t i) { return types[i].size() == 1 ? types[i][0] : types[i][size]; };
      BuiltIn function{words[1], type(0), {}};
      for (std::size_t i = 2; i < words.size(); ++i) function.parameters.push_back({type(i), words[i][0] == '>'});
      add(library, function);
    }
  }
  return library;
}

const Library& library() {
  static const Library result = read_table();
  return result;
}

}  // namespace

std::string BuiltIn::signature() const {
  std::string types;
  for (const Parameter& parameter : parameters) types += parameter.type + ",";
  return types;
}

const std::vector<BuiltIn>& built_in_overloads(std::string_view name) {
  static const std::vector<BuiltIn> no_overloads;
  const auto found = library().overloads.find(std::string(name));
  return found == library().overloads.end() ? no_overloads : found->second;
}

const std::vector<std::string_view>& built_in_functions() {
  static const std::vector<std::string_view> names(library().names.begin(), library().names.end());
  return names;
}

}  // namespace dmvv::compiler::snippet
