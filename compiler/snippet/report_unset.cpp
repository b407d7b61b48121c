// A variable is found again by its name near the line that glslang gives it.
#include "compiler/snippet/report_unset.h"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

#include "compiler/snippet/probe_points.h"
#include "compiler/snippet/unset_reads.h"

namespace dmvv::compiler::snippet {

namespace {

/// The mention of a name that is nearest to a line of the shader, in the line's statement.
const Token* mention_near(const Shader& shader, std::uint32_t line, std::string_view name) {
  if (line == 0 || line > shader.lines.size()) return nullptr;
  const auto is_here = [&](std::size_t i) {
    const Line& other = shader.lines[i];
    return other.statement == shader.lines[line - 1].statement && !other.behind && other.token->word == name;
  };
  for (std::size_t away = 0; away < shader.lines.size(); ++away) {
    if (line - 1 + away < shader.lines.size() && is_here(line - 1 + away)) return shader.lines[line - 1 + away].token;
    if (away < line && is_here(line - 1 - away)) return shader.lines[line - 1 - away].token;
  }
  return nullptr;
}

const Token* declaration_before(const Prepared& prepared, const Token& use) {
  const std::vector<Token>& tokens = prepared.texts[use.text].tokens;
  for (auto i = static_cast<std::size_t>(&use - tokens.data()) + 1; i-- > 0;) {
    if (!tokens[i].is(use.word)) continue;
    const bool follows_comma = i > 0 && tokens[i - 1].is(",") && i + 1 < tokens.size() &&
                               (tokens[i + 1].is(",") || tokens[i + 1].is(";") || tokens[i + 1].is("="));
    if (follows_comma || is_declaration(tokens, i)) return &tokens[i];
  }
  return nullptr;
}

}  // namespace

void report_unset(const std::vector<std::uint32_t>& spirv, bool uses_time, const Prepared& prepared,
                  const Shader& shader, Reporter& reporter) {
  for (const UnsetRead& read : find_unset_reads(shader.glsl, shader.literals, spirv)) {
    const Token* mention = mention_near(shader, read.variable.line, read.variable.name);
    const std::string where = describe(read.p, read.t_ms, uses_time);
    const std::string_view name = mention != nullptr ? mention->author : std::string_view(read.variable.name);
    std::string message =
        read.variable.is_out
            ? fmt::format(
                  "the 'out' parameter '{}' is not set on every way through its function, as at {}; set it first", name,
                  where)
            : fmt::format("the variable '{}' is read before it is set, as at {}; give it a value where it is declared",
                          name, where);
    const Token* declared = mention != nullptr ? declaration_before(prepared, *mention) : nullptr;
    std::vector<Note> notes;
    if (declared != nullptr && declared != mention)
      notes.push_back({reporter.span_of(*declared), "it is declared here"});
    reporter.warn(Code::snippet_unset_variable, mention != nullptr ? reporter.span_of(*mention) : reporter.body_words(),
                  std::move(message), std::move(notes));
  }
}

}  // namespace dmvv::compiler::snippet
