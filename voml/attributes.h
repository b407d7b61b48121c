// Inside voml: the attributes of one element, by name without regard to case, each fault at its value.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text.h"
#include "voml/scene.h"
#include "voml/xml_document.h"

namespace dmvv::voml {

/// All attributes that an element may have, wherever it stands, in canonical order; none for Tag::unknown. The table in
/// spec/voml.md and the schema spec/voml.rng say the same.
std::span<const std::string_view> attributes_of(Tag tag);

/// Reads the attributes of an element. Every getter reports what is wrong with a value and then returns nothing (or the
/// default), so one mistake gives one message.
class Attributes {
 public:
  /// Reports E0202.
  Attributes(Element element, Diagnostics& diagnostics);

  /// Reports the unknown ones (W0103) but those that `required` found to be a misspelt needed one. Call it last.
  void report_unknown();

  bool has(std::string_view name) const { return static_cast<bool>(find(name)); }
  /// Whether an unknown attribute may be a typo of `name`.
  bool has_misspelt(std::string_view name) const;
  /// Whether there is an attribute other than `name`, known or nearly so.
  bool has_other_than(std::string_view name) const;
  /// The place of the value; that of the element's name if it has no such attribute.
  Span span(std::string_view name) const;

  /// A text that is not blank, without the blanks around it. Errors: E0209.
  std::optional<std::string> text(std::string_view name);
  /// The same for one that must be there; `why` ends the sentence "SDF needs the attribute 'file'". Errors: E0201.
  std::optional<std::string> required_text(std::string_view name, std::string_view why = {});
  /// Reports E0201 and returns false if the attribute is missing.
  bool require(std::string_view name, std::string_view why = {});

  std::optional<double> number(std::string_view name);
  std::optional<glm::dvec3> vector(std::string_view name);
  /// Three counts of cells for a lookup grid.
  std::optional<glm::uvec3> index_size(std::string_view name);
  /// translate, rotate, scale. Errors: E0203, E0205, E0206.
  Transform transform();

  /// One of a few words, without regard to case. Errors: E0208.
  template <class T>
  std::optional<T> choice(std::string_view name, std::initializer_list<std::pair<std::string_view, T>> words) {
    if (!has(name)) return std::nullopt;
    const std::string_view value = trim(find(name).value());
    std::vector<std::string_view> known;
    for (const auto& [word, meaning] : words) {
      if (same_word(word, value)) return meaning;
      known.push_back(word);
    }
    report_bad_choice(name, value, known);
    return std::nullopt;
  }

  /// W0106 for an attribute that has no effect; `why` as in "'rgb' is ignored: the type is not color".
  void warn_ignored(std::string_view name, std::string_view why);

 private:
  struct Known {
    std::string_view name;
    pugi::xml_attribute attribute;  ///< null if the element does not have it
  };
  struct Unknown {
    pugi::xml_attribute attribute;
    std::optional<std::string_view> meant;  ///< the known attribute it may be a typo of
  };

  pugi::xml_attribute find(std::string_view name) const;
  std::vector<std::string_view> known_names() const;
  void report_number(std::string_view name, const NumberFault& fault, Code wrong, std::string_view what);
  void report_bad_choice(std::string_view name, std::string_view value, const std::vector<std::string_view>& known);

  Element element_;
  Diagnostics* diagnostics_;
  std::vector<Known> known_;
  std::vector<Unknown> unknown_;
};

}  // namespace dmvv::voml
