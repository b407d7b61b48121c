// A mangled name is led back to the token that defines the function, or to the call that is wrong.
#include "compiler/snippet/report_functions.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "compiler/snippet/assemble_shader.h"
#include "compiler/snippet/missing_return.h"
#include "compiler/snippet/names.h"

namespace dmvv::compiler::snippet {

namespace {

/// "g(vf3;" -> "g"
std::string_view plain_name(std::string_view mangled) {
  const std::size_t begin = std::min(mangled.find_first_not_of(" \t"), mangled.size());
  return mangled.substr(begin, std::min(mangled.find('(', begin), mangled.size()) - begin);
}

const Token* call_in(std::string_view caller, std::string_view callee, const Prepared& prepared, Definitions& defined) {
  const auto search = [&](const std::vector<Token>& tokens, std::size_t i) -> const Token* {
    for (std::size_t depth = 0; i + 1 < tokens.size(); ++i) {
      if (tokens[i].is("{")) ++depth;
      if (tokens[i].is("}") && --depth == 0) return nullptr;
      if (depth > 0 && tokens[i].is(callee) && tokens[i + 1].is("(")) return &tokens[i];
    }
    return nullptr;
  };
  if (caller == body_function) {
    for (const Token& token : prepared.texts.back().tokens) {
      if (token.is(callee)) return &token;
    }
  }
  for (const Token* definition : defined.of(caller)) {
    const std::vector<Token>& tokens = prepared.texts[definition->text].tokens;
    const Token* call = search(tokens, static_cast<std::size_t>(definition - tokens.data()));
    if (call != nullptr) return call;
  }
  return nullptr;
}

/// glslang lists the calls of a cycle: "g(f1; calling h(f1;".
void report_recursion(std::string_view list, const Prepared& prepared, Definitions& defined, Reporter& reporter) {
  constexpr std::string_view calling = " calling ";
  const std::size_t at = list.find(calling);
  if (at == std::string_view::npos) return;
  const std::string_view caller = plain_name(list.substr(list.rfind('\n', at) + 1));
  const std::string_view callee = plain_name(list.substr(at + calling.size()));
  const std::string message =
      caller == callee
          ? fmt::format("'{}' calls itself; a shader has no stack, write a loop instead", author_word(caller))
          : fmt::format("'{}' calls '{}', which calls it again; a shader has no stack, write a loop instead",
                        author_word(caller), author_word(callee));
  if (const Token* call = call_in(caller, callee, prepared, defined))
    return reporter.report(Code::snippet_recursion, *call, message);
  reporter.report(Code::snippet_recursion, reporter.body_words(), message);
}

}  // namespace

void report_linking(const LogEntry& entry, const Prepared& prepared, Definitions& defined, Reporter& reporter) {
  constexpr std::string_view no_body = "No function definition (body) found:";
  if (entry.reason.find("Recursion detected") != std::string::npos)
    return report_recursion(entry.reason, prepared, defined, reporter);
  if (const std::size_t at = entry.reason.find(no_body); at != std::string::npos) {
    const std::size_t name_at =
        std::min(entry.reason.find_first_not_of(" \t\n", at + no_body.size()), entry.reason.size());
    const std::string_view name = plain_name(std::string_view(entry.reason).substr(name_at));
    for (const PreparedText& text : prepared.texts) {
      for (const Token& token : text.tokens) {
        if (token.is(name)) {
          return reporter.report(Code::snippet_unknown_name, token,
                                 fmt::format("the function '{}' is declared, but not defined", token.author));
        }
      }
    }
  }
  reporter.report(Code::snippet_syntax, reporter.body_words(),
                  fmt::format("the function does not link: {}", entry.reason));
}

void report_missing_returns(const std::vector<std::uint32_t>& spirv, Definitions& defined, Reporter& reporter) {
  constexpr std::string_view message = "not every way through this function ends in a 'return'";
  for (const std::string& mangled : functions_without_return(spirv)) {
    const std::string_view name = plain_name(mangled);
    if (name == body_function) {
      reporter.report(Code::snippet_return, reporter.body_words(), std::string(message));
      continue;
    }
    const std::vector<const Token*>& definitions = defined.of(name);
    if (!definitions.empty()) reporter.report(Code::snippet_return, *definitions.front(), std::string(message));
  }
}

}  // namespace dmvv::compiler::snippet
