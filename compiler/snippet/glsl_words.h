// Inside compiler/snippet: what the words of GLSL and Cg mean in a distance function.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dmvv::compiler::snippet {

/// GLSL's types that a distance function can use.
const std::vector<std::string>& type_names();
bool is_type(std::string_view word);

/// Whether the word is one of the language, but neither a type nor a function: `return`, `const`.
bool is_keyword(std::string_view word);

/// Whether nothing can be called so: GLSL 4.60, section 3.6, has the word or keeps it for later, or the compiler does.
bool is_reserved(std::string_view word);

/// Whether the word is a type for glslang, as Vulkan has it, and an ordinary name in GLSL 4.60: `texture2D`.
bool is_vulkan_word(std::string_view word);

/// What is said of a reserved word that an author took for a name.
std::string reserved_sentence(std::string_view word);

/// Why a distance function cannot use a word, as the end of a sentence that begins with it; empty if it can.
/// `is_call`: an opening parenthesis follows.
std::string_view why_refused(std::string_view word, bool is_call);

/// Why a word cannot stand in front of a declaration outside of functions, the same way.
std::string_view why_refused_globally(std::string_view word);

/// What GLSL calls a word of Cg; empty if it is none. Functions that GLSL lacks are defined by legacy_functions().
std::string_view legacy_spelling(std::string_view word);

/// GLSL text that defines the functions of Cg that GLSL lacks.
std::string_view legacy_functions();

}  // namespace dmvv::compiler::snippet
