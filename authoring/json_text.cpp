#include "authoring/json_text.h"

#include <algorithm>
#include <string>
#include <vector>

namespace dmvv::authoring {
namespace {

/// A key, or the place in a list.
struct Step {
  std::string key;
  std::size_t index;
};

/// The steps from `root` to `value`, by address. Without recursion: hostile texts are deep.
std::vector<Step> steps_to(const Json& value, const Json& root) {
  struct Level {
    const Json* container;
    Json::const_iterator next;
    std::size_t index;
  };
  std::vector<Level> levels;
  const auto enter = [&](const Json& json) {
    if (json.is_structured()) levels.push_back({&json, json.cbegin(), 0});
  };
  if (&value != &root) enter(root);
  while (!levels.empty()) {
    Level& level = levels.back();
    if (level.next == level.container->cend()) {
      levels.pop_back();
      continue;
    }
    const Json& child = *level.next++;
    ++level.index;
    if (&child == &value) break;
    enter(child);
  }
  std::vector<Step> steps;
  for (Level& level : levels) {
    const bool list = level.container->is_array();
    steps.push_back({list ? std::string() : (--level.next).key(), level.index - 1});
  }
  return steps;
}

/// Follows the parser through the text, token by token, and notes where the value behind some steps stands.
class Locator : public nlohmann::json_sax<Json> {
 public:
  Locator(std::string_view text, std::vector<Step> steps) : text_(text), steps_(std::move(steps)) {}

  JsonPlace place{0, 0};
  std::size_t fault_end = 0;  ///< the parser has read as far, if it stopped
  bool too_large = false;     ///< because of a number

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t&) override { return value(); }
  bool string(string_t&) override { return value(); }
  bool binary(binary_t&) override { return value(); }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    take_token();
    levels_.back().key = name;
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const Json::exception& error) override {
    fault_end = position;
    too_large = error.id == 406;
    return false;
  }

 private:
  struct Level {
    bool list;
    bool on_path;
    std::size_t index;
    std::string key;
  };

  static bool is_between(char c) { return std::string_view(" \t\n\r,:").find(c) != std::string_view::npos; }

  /// The token at the cursor, behind what stands between tokens.
  JsonPlace take_token() {
    while (at_ < text_.size() && is_between(text_[at_])) ++at_;
    const std::size_t begin = at_;
    if (text_[at_] == '"') {
      for (++at_; text_[at_] != '"'; ++at_)
        if (text_[at_] == '\\') ++at_;
      ++at_;
    } else if (std::string_view("[]{}").find(text_[at_]) != std::string_view::npos) {
      ++at_;
    } else {
      at_ = std::min(text_.find_first_of(" \t\n\r,:]}", at_), text_.size());
    }
    return {begin, at_};
  }

  /// Whether the value that begins here lies on the way to the one that is looked for.
  bool is_on_path() {
    if (levels_.empty()) return true;
    Level& level = levels_.back();
    const std::size_t index = level.index++;
    if (!level.on_path || levels_.size() > steps_.size()) return false;
    const Step& step = steps_[levels_.size() - 1];
    return level.list ? step.index == index : step.key == level.key;
  }

  bool value() {
    const JsonPlace token = take_token();
    if (is_on_path() && levels_.size() == steps_.size()) place = token;
    return true;
  }

  bool open(bool list) {
    const JsonPlace token = take_token();
    const bool on_path = is_on_path();
    if (on_path && levels_.size() == steps_.size()) place = token;
    levels_.push_back({list, on_path, 0, {}});
    return true;
  }

  bool close() {
    take_token();
    levels_.pop_back();
    return true;
  }

  std::string_view text_;
  std::vector<Step> steps_;
  std::vector<Level> levels_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<Json> parse_json(std::string_view text, JsonFault& fault) {
  try {
    return Json::parse(text);
  } catch (const Json::exception&) {
  }
  Locator locator(text, {});
  Json::sax_parse(text, &locator);
  const std::size_t end = std::min(locator.fault_end, text.size());
  const std::size_t begin = end - std::min<std::size_t>(end, 1);
  if (locator.too_large) {
    const std::size_t before = text.find_last_of(" \t\n\r,:[", begin);
    fault = {{before == text.npos ? 0 : before + 1, end}, "a number is larger than any double"};
  } else {
    fault = {{begin, begin}, "the text is not JSON here"};
  }
  return std::nullopt;
}

JsonPlace place_of(const Json& value, const Json& root, std::string_view text) {
  Locator locator(text, steps_to(value, root));
  Json::sax_parse(text, &locator);
  return locator.place;
}

}  // namespace dmvv::authoring
