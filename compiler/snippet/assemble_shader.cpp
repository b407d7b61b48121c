// A shader begins with what the author may call; each of the author's texts follows, the body as the last function.
#include "compiler/snippet/assemble_shader.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "compiler/snippet/glsl_words.h"
#include "compiler/snippet/library.h"

namespace dmvv::compiler::snippet {

namespace {

class Assembler {
 public:
  explicit Assembler(const Prepared& prepared) : prepared_(prepared) {}

  Shader run() {
    std::unordered_set<std::string_view> words;
    for (const PreparedText& text : prepared_.texts) {
      for (const Token& token : text.tokens) words.insert(token.word);
    }
    add("#version 460\n"
        "layout(location = 0) in vec3 dmvv_p;\n"
        "layout(location = 1) in float dmvv_t;\n"
        "layout(location = 0) out float dmvv_distance;\n");
    std::size_t numbers = 0;
    for (const PreparedText& text : prepared_.texts) {
      numbers += static_cast<std::size_t>(std::ranges::count(text.tokens, Token::Kind::number, &Token::kind));
    }
    keeps_literals_ = numbers >= Literals::least;
    const std::size_t declarations = shader_.glsl.size();
    if (keeps_literals_) add("\n");  // of the array, which is known at the end
    if (prepared_.uses_legacy_functions) add(legacy_functions());
    if (prepared_.uses_library) add(library_for(words));
    const std::size_t body = prepared_.texts.size() - 1;
    for (std::size_t i = 0; i < body; ++i) {
      add_forwards(prepared_.texts[i]);
      add_text(prepared_.texts[i]);
      add(fmt::format("const int dmvv_end_{} = 0;\n", i));  // where a text ends in the middle, its fault stands here
    }
    add_forwards(prepared_.texts[body]);
    last_ = nullptr;
    add(fmt::format("float {}(vec3 p, float t) {{\n", body_function));
    depth_ = 1;
    add_text(prepared_.texts[body]);
    if (keeps_literals_)
      shader_.glsl.replace(declarations, 1, shader_.literals.empty() ? "\n" : shader_.literals.declaration());
    add(fmt::format("}}\nvoid main() {{ dmvv_distance = {}(dmvv_p, dmvv_t); }}\n", body_function));
    return std::move(shader_);
  }

 private:
  /// A number may stand in the array of literals where GLSL does not ask for a constant: in a function, but not in the
  /// value of a constant nor in the size of an array.
  bool may_be_kept(const Token& token) {
    if (!keeps_literals_) return false;
    depth_ += token.is("{") ? 1 : token.is("}") ? -1 : 0;
    brackets_ += token.is("[") ? 1 : token.is("]") ? -1 : 0;
    if (token.is("const")) in_constant_ = true;
    if (token.is(";") || token.is("{")) in_constant_ = false;
    return depth_ > 0 && brackets_ == 0 && !in_constant_ && token.kind == Token::Kind::number &&
           is_float_literal(token.word);
  }

  void add(std::string_view ours) {
    shader_.glsl += ours;
    shader_.lines.insert(shader_.lines.end(), static_cast<std::size_t>(std::count(ours.begin(), ours.end(), '\n')),
                         {last_, true, false, statement_});
  }

  void add_forwards(const PreparedText& text) {
    const std::size_t first = shader_.lines.size();
    add(text.forwards);
    for (std::size_t i = first; i < shader_.lines.size(); ++i) shader_.lines[i].forwards = true;
  }

  void add_text(const PreparedText& text) {
    ++statement_;
    for (const Token& token : text.tokens) {
      last_ = &token;
      shader_.glsl.append(may_be_kept(token) ? shader_.literals.place_of(token.word) : std::string(token.word))
          .append("\n");
      shader_.lines.push_back({last_, false, false, statement_});
      if (token.is(";") || token.is("{") || token.is("}")) ++statement_;
    }
  }

  const Prepared& prepared_;
  Shader shader_;
  const Token* last_ = nullptr;
  std::uint32_t statement_ = 0;
  bool keeps_literals_ = false;
  bool in_constant_ = false;
  int depth_ = 0;  ///< of braces
  int brackets_ = 0;
};

}  // namespace

Shader assemble_shader(const Prepared& prepared) { return Assembler(prepared).run(); }

}  // namespace dmvv::compiler::snippet
