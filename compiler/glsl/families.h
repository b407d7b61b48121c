// Functions of a shader that are equal but for their literals, made one: the literals that differ become parameters,
// read from a buffer by the row at which a member's begin. Anti-unification (Plotkin 1970) of GLSL text.
//
//   float function_3(vec3 p) { return length(p) - 0.5; }       float function_3_united(uint row, vec3 p) {
//   float function_4(vec3 p) { return length(p) - 0.7; }   ->    uvec4 k0 = parameter_at(row);
//                                                                return length(p) - uintBitsToFloat(k0.x); }
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace dmvv::compiler {

/// The functions of a shader, each as GLSL text, callees before callers.
///
/// Two functions have the same shape if their texts are equal but for comments, the function's own name, the values of
/// literals, and functions called in their place that again have the same shape. Constant arrays may also differ in
/// length. Values are copied bit by bit, and no operation is added, left out or moved.
class Families {
 public:
  /// Adds a definition, with the helpers before it whose names begin with `name` and an underscore. `text` begins with
  /// comments or the definition, which is the last one in it.
  void add(const std::string& name, const std::string& text);

  bool knows(const std::string& name) const { return numbers_.contains(name); }
  /// The function's shape: functions that are equal but for their numbers have the same.
  std::uint32_t shape(const std::string& name) const { return functions_[numbers_.at(name)].shape; }

  /// Merges functions of one shape into one function whose first argument is a row of `parameters`. Returns the name of
  /// the merged function; the originals stay available.
  std::string unite(const std::vector<std::string>& names);

  /// Gives each member of the united functions its row; nothing is added or united after this.
  void settle();
  /// Where a member's parameters begin. Only for names that were united.
  std::uint32_t row(const std::string& name) const { return functions_[numbers_.at(name)].row; }
  const std::vector<glm::uvec4>& parameters() const { return parameters_; }

  /// The text of these functions in their order, each after what it calls; what was given out before is left out.
  std::string take(const std::vector<std::string>& names);
  /// Likewise, for a text of its own: to be given out again.
  std::string copy(const std::vector<std::string>& names);

 private:
  struct Token {
    enum class Kind : std::uint8_t { text, comment, own_name, literal, callee, united, table, element, element_end };
    Kind kind;
    std::string text;                   ///< as written; of own_name what follows the name
    std::uint32_t callee = 0;           ///< number of a function; a shape for united ones
    std::uint32_t column = 0;           ///< of a table or element: which of the function's constant arrays
    std::vector<std::string> values{};  ///< of a table
  };
  struct Function {
    std::string name;
    std::vector<Token> tokens;
    std::uint32_t shape = 0;
    std::uint32_t level = 0;  ///< 1 more than that of any callee
    std::uint32_t row = 0;
    bool is_taken = false;
  };
  /// A parameter: a literal of one type, and its value for each member.
  struct Slot {
    char type;
    std::vector<std::string> values;
    friend auto operator<=>(const Slot&, const Slot&) = default;
  };
  struct Union {
    std::set<std::uint32_t> members;
    std::vector<Slot> slots;
    std::map<std::size_t, std::size_t> slot_of_token;
    std::set<std::size_t> united_callees;  ///< tokens: members call different functions there
    bool has_table = false;                ///< the members' constant arrays differ
    std::uint32_t columns = 0;
    bool is_taken = false;
  };

  std::vector<Token> tokens_of(const std::string& name, const std::string& text) const;
  std::string shape_text(const Function& function) const;
  std::string united_name(std::uint32_t shape) const;
  void compare(std::uint32_t shape);
  void compare_token(Union& united, std::size_t token);
  void lay_out(const Union& united);
  void lay_out_table(const Union& united, const Function& member);
  void take(std::uint32_t function, std::string& text);
  void take_united(std::uint32_t shape, std::string& text);
  std::string united_text(const Union& united) const;
  std::string rows_text(const Union& united) const;
  std::string united_row(const Union& united, std::size_t token) const;
  std::string united_token(const Union& united, std::size_t token) const;

  std::vector<Function> functions_;
  std::map<std::string, std::uint32_t, std::less<>> numbers_;
  std::map<std::string, std::uint32_t> shapes_;
  std::map<std::uint32_t, Union> unions_;  ///< by shape
  std::map<std::string, std::uint32_t, std::less<>> united_names_;
  std::vector<glm::uvec4> parameters_;
};

}  // namespace dmvv::compiler
