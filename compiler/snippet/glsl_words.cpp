#include "compiler/snippet/glsl_words.h"

#include <fmt/format.h>

#include <map>
#include <string>
#include <unordered_set>

namespace dmvv::compiler::snippet {
namespace {

using Words = std::unordered_set<std::string_view>;

constexpr std::string_view no_texture =
    "reads textures or images, but a distance function knows p and t alone; a sampled distance is an SDF with a file";
constexpr std::string_view no_derivative =
    "compares neighbouring pixels, but a distance is evaluated at single points; take differences of the function "
    "itself";
constexpr std::string_view no_sharing =
    "works with what other invocations see, but a distance is evaluated at single points";
constexpr std::string_view no_discard =
    "throws a pixel away, but a distance is evaluated at single points; return a positive value for 'outside'";
constexpr std::string_view no_built_in_variable =
    "belongs to a shader stage, but a distance function knows p and t alone";
constexpr std::string_view no_interface = "declares data from outside, but a distance function knows p and t alone";
constexpr std::string_view no_double = "is a 64-bit type, but distances are computed in float32 on the device";

/// sampler2D, isamplerCubeArray, sampler2DShadow, image3D, ...
bool is_opaque_type(std::string_view word) {
  static const Words dimensions = {"1D",      "2D",        "3D",     "Cube", "2DRect",    "1DArray",
                                   "2DArray", "CubeArray", "Buffer", "2DMS", "2DMSArray", ""};
  if (word == "atomic_uint") return true;
  if (word.starts_with("i") || word.starts_with("u")) {
    if (is_opaque_type(word.substr(1))) return true;
  }
  for (const std::string_view kind : {"sampler", "texture", "image", "subpassInput"}) {
    if (!word.starts_with(kind)) continue;
    std::string_view rest = word.substr(kind.size());
    if (rest.empty()) return kind != "texture" && kind != "image";  // `texture` is a function, `image` a name
    if (rest.ends_with("Shadow")) rest.remove_suffix(6);
    if (dimensions.contains(rest)) return true;
  }
  return false;
}

bool is_texture_function(std::string_view word) {
  static const Words names = {"texture",
                              "textureSize",
                              "textureQueryLod",
                              "textureQueryLevels",
                              "textureSamples",
                              "textureProj",
                              "textureLod",
                              "textureOffset",
                              "texelFetch",
                              "texelFetchOffset",
                              "textureProjOffset",
                              "textureLodOffset",
                              "textureProjLod",
                              "textureProjLodOffset",
                              "textureGrad",
                              "textureGradOffset",
                              "textureProjGrad",
                              "textureProjGradOffset",
                              "textureGather",
                              "textureGatherOffset",
                              "textureGatherOffsets",
                              "imageSize",
                              "imageSamples",
                              "imageLoad",
                              "imageStore",
                              "subpassLoad",
                              "tex1D",
                              "tex2D",
                              "tex3D",
                              "texCUBE",
                              "tex2Dlod",
                              "tex3Dlod",
                              "tex2Dproj",
                              "texture1D",
                              "texture2D",
                              "texture3D",
                              "textureCube",
                              "shadow1D",
                              "shadow2D"};
  return names.contains(word) || word.starts_with("imageAtomic");
}

bool is_derivative(std::string_view word) {
  static const Words names = {"dFdx",
                              "dFdy",
                              "fwidth",
                              "dFdxFine",
                              "dFdyFine",
                              "fwidthFine",
                              "dFdxCoarse",
                              "dFdyCoarse",
                              "fwidthCoarse",
                              "ddx",
                              "ddy",
                              "interpolateAtCentroid",
                              "interpolateAtSample",
                              "interpolateAtOffset"};
  return names.contains(word);
}

bool is_shared_work(std::string_view word) {
  static const Words names = {"barrier",
                              "memoryBarrier",
                              "memoryBarrierAtomicCounter",
                              "memoryBarrierBuffer",
                              "memoryBarrierShared",
                              "memoryBarrierImage",
                              "groupMemoryBarrier",
                              "EmitVertex",
                              "EndPrimitive",
                              "EmitStreamVertex",
                              "EndStreamPrimitive",
                              "anyInvocation",
                              "allInvocations",
                              "allInvocationsEqual"};
  return names.contains(word) || word.starts_with("atomic");
}

bool is_interface(std::string_view word) {
  static const Words names = {"layout",   "uniform",  "buffer",   "shared",   "attribute", "varying",
                              "coherent", "volatile", "restrict", "readonly", "writeonly", "subroutine",
                              "patch",    "centroid", "flat",     "smooth",   "invariant", "noperspective"};
  return names.contains(word);
}

bool is_double(std::string_view word) {
  return word == "double" || (word.size() == 5 && word.starts_with("dvec")) || word.starts_with("dmat");
}

using Spellings = std::map<std::string, std::string, std::less<>>;

/// A Cg matrix has rows where GLSL has columns: floatRxC becomes matRxC, R columns of C, and mul turns its factors
/// round.
Spellings make_spellings() {
  Spellings result = {
      {"lerp", "mix"},          {"frac", "fract"},   {"rsqrt", "inversesqrt"},      {"atan2", "atan"},
      {"fmod", "dmvv_fmod"},    {"mul", "dmvv_mul"}, {"saturate", "dmvv_saturate"}, {"log10", "dmvv_log10"},
      {"sincos", "dmvv_sincos"}};
  const auto add = [&](const std::string& cg, const std::string& scalar, const std::string& vector, bool matrices) {
    if (cg != scalar) result[cg] = scalar;
    result[cg + "1"] = scalar;
    for (const char n : {'2', '3', '4'}) {
      result[cg + n] = vector + n;
      for (const char m : {'2', '3', '4'}) {
        if (matrices) result[cg + n + 'x' + m] = std::string("mat") + n + 'x' + m;
      }
    }
  };
  for (const char* real : {"float", "half", "fixed"}) add(real, "float", "vec", true);
  add("int", "int", "ivec", false);
  add("uint", "uint", "uvec", false);
  add("bool", "bool", "bvec", false);
  return result;
}

const Spellings& spellings() {
  static const Spellings table = make_spellings();
  return table;
}

}  // namespace

const std::vector<std::string>& type_names() {
  static const std::vector<std::string> result = [] {
    std::vector<std::string> names = {"float", "int", "uint", "bool", "void"};
    for (const char size : {'2', '3', '4'}) {
      for (const char* vector : {"vec", "ivec", "uvec", "bvec"}) names.push_back(std::string(vector) + size);
      names.push_back(std::string("mat") + size);
      for (const char rows : {'2', '3', '4'}) names.push_back(std::string("mat") + size + 'x' + rows);
    }
    return names;
  }();
  return result;
}

bool is_type(std::string_view word) {
  static const Words words(type_names().begin(), type_names().end());
  return words.contains(word);
}

bool is_keyword(std::string_view word) {
  static const Words words = {"const",     "in",      "out",     "inout",  "struct", "if",      "else",
                              "for",       "while",   "do",      "switch", "case",   "default", "break",
                              "continue",  "return",  "true",    "false",  "lowp",   "mediump", "highp",
                              "precision", "precise", "discard", "static", "inline"};
  return words.contains(word);
}

bool is_vulkan_word(std::string_view word) {
  if (word.starts_with("i") || word.starts_with("u")) word.remove_prefix(1);
  const bool has_kind = word.starts_with("texture") || word.starts_with("subpassInput");
  return (has_kind && is_opaque_type(word)) || word == "sampler" || word == "samplerShadow";
}

bool is_reserved(std::string_view word) {
  if (is_vulkan_word(word)) return false;
  static const Words words = {
      "attribute", "coherent",  "volatile",      "restrict",      "readonly", "writeonly", "subroutine", "sample",
      "common",    "partition", "active",        "asm",           "class",    "union",     "enum",       "typedef",
      "template",  "this",      "resource",      "goto",          "noinline", "public",    "extern",     "external",
      "interface", "long",      "short",         "unsigned",      "superp",   "input",     "output",     "hvec2",
      "hvec3",     "hvec4",     "fvec2",         "fvec3",         "fvec4",    "filter",    "sizeof",     "cast",
      "namespace", "using",     "sampler3DRect", "uniform",       "buffer",   "shared",    "varying",    "layout",
      "centroid",  "flat",      "smooth",        "noperspective", "patch",    "invariant", "half",       "fixed",
      "static",    "inline"};
  return words.contains(word) || is_type(word) || is_keyword(word) || is_double(word) || is_opaque_type(word) ||
         word.starts_with("gl_") || word.starts_with("dmvv_");
}

std::string reserved_sentence(std::string_view word) {
  return fmt::format("'{}' is a word that {} keeps for itself; take another name", word,
                     word.starts_with("dmvv_") ? "the compiler" : "GLSL");
}

std::string_view why_refused(std::string_view word, bool is_call) {
  if (is_opaque_type(word) && (!is_call || !is_texture_function(word))) return no_texture;
  if (is_call && is_texture_function(word)) return no_texture;
  if (is_call && is_derivative(word)) return no_derivative;
  if (is_call && is_shared_work(word)) return no_sharing;
  if (word == "discard") return no_discard;
  if (word.starts_with("gl_")) return no_built_in_variable;
  if (is_interface(word)) return no_interface;
  if (is_double(word)) return no_double;
  return {};
}

std::string_view why_refused_globally(std::string_view word) {
  return word == "in" || word == "out" || word == "inout" ? no_interface : std::string_view();
}

std::string_view legacy_spelling(std::string_view word) {
  const auto found = spellings().find(word);
  return found == spellings().end() ? std::string_view() : std::string_view(found->second);
}

std::string_view legacy_functions() {
  static const std::string text = [] {
    std::string result =
        "float dmvv_log10(float x) { return log2(x) * 0.301029995663981195; }\n"
        "void dmvv_sincos(float x, out float s, out float c) { s = sin(x); c = cos(x); }\n";
    for (const std::string vec : {"float", "vec2", "vec3", "vec4"}) {
      result += vec + " dmvv_saturate(" + vec + " x) { return clamp(x, 0.0, 1.0); }\n";
      result += vec + " dmvv_fmod(" + vec + " x, " + vec + " y) { return x - y * trunc(x / y); }\n";
      if (vec != "float") result += vec + " dmvv_fmod(" + vec + " x, float y) { return x - y * trunc(x / y); }\n";
    }
    const auto mul = [&](const std::string& to, const std::string& a, const std::string& b) {
      result += to + " dmvv_mul(" + a + " a, " + b + " b) { return b * a; }\n";
    };
    for (const std::string r : {"2", "3", "4"}) {
      for (const std::string c : {"2", "3", "4"}) {
        const std::string matrix = "mat" + r + "x" + c;
        mul("vec" + r, matrix, "vec" + c);
        mul("vec" + c, "vec" + r, matrix);
        for (const std::string n : {"2", "3", "4"}) mul("mat" + r + "x" + n, matrix, "mat" + c + "x" + n);
      }
    }
    return result;
  }();
  return text;
}

}  // namespace dmvv::compiler::snippet
