// Typed indices: an Id<Sdf> cannot be used where an Id<Region> is meant.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace dmvv {

/// Index of a T in the vector that owns all T of a scene or module.
template <class T>
struct Id {
  std::uint32_t index = invalid_index;

  static constexpr std::uint32_t invalid_index = 0xffffffffu;

  constexpr bool valid() const { return index != invalid_index; }
  friend constexpr bool operator==(Id, Id) = default;
  friend constexpr auto operator<=>(Id, Id) = default;
};

/// The element that `id` names. The id must be valid and come from the same owner.
template <class T>
const T& at(const std::vector<T>& owner, Id<T> id) {
  return owner[id.index];
}
template <class T>
T& at(std::vector<T>& owner, Id<T> id) {
  return owner[id.index];
}

/// Appends `value` and returns its id.
template <class T>
Id<T> append(std::vector<T>& owner, T value) {
  owner.push_back(std::move(value));
  return Id<T>{static_cast<std::uint32_t>(owner.size() - 1)};
}

}  // namespace dmvv
