#include "voml/attributes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/limits.h"

namespace dmvv::voml {

std::span<const std::string_view> attributes_of(Tag tag) {
  static constexpr std::string_view import_file[] = {"file"};
  static constexpr std::string_view named[] = {"name"};  // OBJECT, MAPPINGS
  static constexpr std::string_view sdf[] = {"name",      "file",  "function",  "type",   "seedFile", "rotateFile",
                                             "scaleFile", "index", "translate", "rotate", "scale",    "offset"};
  static constexpr std::string_view region[] = {"name",      "type",   "rgb",   "file",
                                                "translate", "rotate", "scale", "opacity"};
  static constexpr std::string_view index[] = {"size", "translate", "rotate", "scale"};
  static constexpr std::string_view embedded[] = {"name",      "type",      "seedFile", "rotateFile",
                                                  "scaleFile", "translate", "rotate",   "scale"};
  static constexpr std::string_view side[] = {"region"};
  switch (tag) {
    case Tag::import_file:
      return import_file;
    case Tag::object:
    case Tag::mappings:
      return named;
    case Tag::sdf:
      return sdf;
    case Tag::region:
      return region;
    case Tag::index:
      return index;
    case Tag::embedded:
      return embedded;
    case Tag::positive:
    case Tag::negative:
      return side;
    case Tag::mvv:
    case Tag::functions:
    case Tag::unknown:
      break;
  }
  return {};
}

Attributes::Attributes(Element element, Diagnostics& diagnostics) : element_(element), diagnostics_(&diagnostics) {
  for (const std::string_view name : attributes_of(element.tag())) known_.push_back({name, {}});
  for (const pugi::xml_attribute attribute : element.node.attributes()) {
    const auto slot =
        std::find_if(known_.begin(), known_.end(), [&](const Known& k) { return same_word(k.name, attribute.name()); });
    if (slot == known_.end()) {
      // Elements of honest scenes have a handful of attributes; suggestions for the first ones are enough.
      const bool suggest = unknown_.size() < Diagnostics::cap;
      unknown_.push_back(
          {attribute, suggest ? nearest_name(lower_case(attribute.name()), known_names()) : std::nullopt});
    } else if (slot->attribute) {
      diagnostics.report(Code::duplicate_attribute, element.document->name_span(attribute),
                         fmt::format("attribute '{}' is given twice", slot->name),
                         {{element.document->name_span(slot->attribute), "first given here"}});
    } else {
      slot->attribute = attribute;
    }
  }
}

pugi::xml_attribute Attributes::find(std::string_view name) const {
  const auto found = std::find_if(known_.begin(), known_.end(), [&](const Known& k) { return k.name == name; });
  return found == known_.end() ? pugi::xml_attribute() : found->attribute;
}

std::vector<std::string_view> Attributes::known_names() const {
  std::vector<std::string_view> names;
  for (const Known& k : known_) names.push_back(k.name);
  return names;
}

void Attributes::report_unknown() {
  for (const Unknown& unknown : unknown_) {
    const std::string suggestion = unknown.meant ? fmt::format("; did you mean '{}'?", *unknown.meant) : "";
    diagnostics_->report(
        Code::unknown_attribute, element_.document->name_span(unknown.attribute),
        fmt::format("{} has no attribute {}{}", element_.title(), in_quotes(unknown.attribute.name()), suggestion));
  }
  unknown_.clear();
}

bool Attributes::has_misspelt(std::string_view name) const {
  return std::any_of(unknown_.begin(), unknown_.end(), [&](const Unknown& u) { return u.meant == name; });
}

bool Attributes::has_other_than(std::string_view name) const {
  return std::any_of(known_.begin(), known_.end(), [&](const Known& k) { return k.attribute && k.name != name; }) ||
         std::any_of(unknown_.begin(), unknown_.end(), [&](const Unknown& u) { return u.meant && *u.meant != name; });
}

Span Attributes::span(std::string_view name) const {
  const pugi::xml_attribute attribute = find(name);
  return attribute ? element_.document->value_span(attribute) : element_.name_span();
}

bool Attributes::require(std::string_view name, std::string_view why) {
  if (has(name)) return true;
  const std::string needs = fmt::format("{} needs the attribute '{}'{}", element_.title(), name, why);
  const auto typo = std::find_if(unknown_.begin(), unknown_.end(), [&](const Unknown& u) { return u.meant == name; });
  if (typo == unknown_.end()) {
    diagnostics_->report(Code::missing_attribute, element_.name_span(), needs);
    return false;
  }
  diagnostics_->report(Code::missing_attribute, element_.document->name_span(typo->attribute),
                       fmt::format("{}; did you mean it by {}?", needs, in_quotes(typo->attribute.name())));
  unknown_.erase(typo);
  return false;
}

std::optional<std::string> Attributes::text(std::string_view name) {
  if (!has(name)) return std::nullopt;
  const std::string_view value = trim(find(name).value());
  if (value.empty()) {
    diagnostics_->report(Code::empty_value, span(name), fmt::format("attribute '{}' is empty", name));
    return std::nullopt;
  }
  return std::string(value);
}

std::optional<std::string> Attributes::required_text(std::string_view name, std::string_view why) {
  return require(name, why) ? text(name) : std::nullopt;
}

void Attributes::report_number(std::string_view name, const NumberFault& fault, Code wrong, std::string_view what) {
  const Code code = fault.kind == NumberFault::Kind::not_finite ? Code::not_finite : wrong;
  diagnostics_->report(code, span(name), fmt::format("attribute '{}' must be {}: {}", name, what, fault.message));
}

std::optional<double> Attributes::number(std::string_view name) {
  if (!has(name)) return std::nullopt;
  const auto value = parse_number(find(name).value());
  if (const auto* number = std::get_if<double>(&value)) return *number;
  report_number(name, std::get<NumberFault>(value), Code::bad_number, "a number");
  return std::nullopt;
}

std::optional<glm::dvec3> Attributes::vector(std::string_view name) {
  if (!has(name)) return std::nullopt;
  const auto value = parse_vector(find(name).value());
  if (const auto* vector = std::get_if<glm::dvec3>(&value)) return *vector;
  report_number(name, std::get<NumberFault>(value), Code::bad_vector, "three numbers");
  return std::nullopt;
}

std::optional<glm::uvec3> Attributes::index_size(std::string_view name) {
  const auto vector_value = vector(name);
  if (!vector_value) return std::nullopt;
  const glm::dvec3 v = *vector_value;
  for (int i = 0; i < 3; ++i) {
    if (v[i] == std::floor(v[i]) && v[i] >= 1.0 && v[i] <= max_index_edge) continue;
    diagnostics_->report(Code::out_of_range, span(name),
                         fmt::format("attribute '{}' must be three whole numbers from 1 to {}, but one is {}", name,
                                     max_index_edge, v[i]));
    return std::nullopt;
  }
  if (v.x * v.y * v.z > static_cast<double>(max_index_cells)) {
    diagnostics_->report(Code::out_of_range, span(name),
                         fmt::format("attribute '{}' makes {:.0f} cells, at most {} are allowed", name, v.x * v.y * v.z,
                                     max_index_cells));
    return std::nullopt;
  }
  return glm::uvec3(v);
}

Transform Attributes::transform() {
  Transform result;
  if (const auto translate = vector("translate")) result.translate = *translate;
  if (const auto rotate = vector("rotate")) result.rotate_deg = *rotate;
  if (const auto scale = vector("scale")) {
    result.scale = *scale;
    for (int i = 0; i < 3; ++i) {
      if (usable_scale(result.scale[i])) continue;
      diagnostics_->report(
          Code::zero_scale, span("scale"),
          fmt::format("the {} component of 'scale' is {}, which leaves nothing to see", "xyz"[i], result.scale[i]));
      break;
    }
  }
  return result;
}

void Attributes::report_bad_choice(std::string_view name, std::string_view value,
                                   const std::vector<std::string_view>& known) {
  const auto near = nearest_name(lower_case(value), known);
  diagnostics_->report(Code::bad_choice, span(name),
                       fmt::format("attribute '{}' is {}, it must be '{}'{}", name, in_quotes(value),
                                   fmt::join(known, "' or '"), near ? fmt::format("; did you mean '{}'?", *near) : ""));
}

void Attributes::warn_ignored(std::string_view name, std::string_view why) {
  if (has(name))
    diagnostics_->report(Code::ignored_attribute, span(name), fmt::format("'{}' is ignored: {}", name, why));
}

}  // namespace dmvv::voml
