#include "compiler/snippet/glslang_front.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "compiler/spirv/glsl_compiler.h"

namespace dmvv::compiler::snippet {
namespace {

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

/// "0:12: 'word' : reason" (parsing) or "Linking vertex stage: reason". What else glslang writes is no error.
LogEntry parse_entry(std::string_view text) {
  LogEntry entry;
  std::uint32_t string = 0;
  const char* const end = text.data() + text.size();
  const auto [colon, fault] = std::from_chars(text.data(), end, string);
  if (fault != std::errc() || colon == end || *colon != ':') {
    const std::size_t stage = text.find("stage: ");
    entry.reason = trim(stage == std::string_view::npos ? text : text.substr(stage + 7));
    return entry;
  }
  const char* const after_line = std::from_chars(colon + 1, end, entry.line).ptr;
  std::string_view rest = trim(std::string_view(after_line, static_cast<std::size_t>(end - after_line)));
  if (rest.starts_with(":")) rest = trim(rest.substr(1));
  const std::size_t quote = rest.starts_with("'") ? rest.find("' :", 1) : std::string_view::npos;
  if (quote != std::string_view::npos) {
    entry.word = rest.substr(1, quote - 1);
    rest = trim(rest.substr(quote + 3));
  }
  entry.reason = rest;
  return entry;
}

/// Lines that do not begin with "ERROR: " belong to the error before them.
std::vector<LogEntry> parse_log(std::string_view log) {
  constexpr std::string_view mark = "ERROR: ";
  std::vector<LogEntry> entries;
  while (!log.empty()) {
    const std::string_view line = trim(log.substr(0, log.find('\n')));
    log.remove_prefix(std::min(log.find('\n'), log.size() - 1) + 1);
    if (line.starts_with(mark)) {
      const std::string_view text = line.substr(mark.size());
      if (text.find("compilation errors") == std::string_view::npos) entries.push_back(parse_entry(text));
    } else if (!line.empty() && !line.starts_with("WARNING") && !entries.empty()) {
      entries.back().reason += "\n";
      entries.back().reason += line;
    }
  }
  return entries;
}

}  // namespace

Compiled compile_vertex_shader(const std::string& glsl, const Literals& literals, const CodeCache& cache) {
  const std::string key = code_key(ShaderStage::vertex, glsl);
  if (auto known = find_code(cache, key); !known.empty()) return {std::move(known), {}};
  CompiledGlsl compiled = compile_glsl(ShaderStage::vertex, glsl);
  if (compiled.spirv.empty()) return {{}, parse_log(compiled.log)};
  compiled.spirv = literals.put_back(std::move(compiled.spirv));
  if (cache.keep) cache.keep(key, compiled.spirv);
  return {std::move(compiled.spirv), {}};
}

}  // namespace dmvv::compiler::snippet
