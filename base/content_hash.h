// What something was made of, as one number: equal hashes, equal bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/files.h"

namespace dmvv {

/// FNV-1a with 128 bits (Fowler, Noll, Vo; RFC 9923). Tells versions apart; no defence against forgery.
class ContentHash {
 public:
  /// The bytes, and that they end here: "ab", "c" differs from "a", "bc".
  void add(std::string_view bytes);
  /// 32 hexadecimal digits.
  std::string digits() const;
  /// "fnv1a-128:" and the digits.
  std::string text() const;

 private:
  void add_byte(unsigned char byte);

  std::uint64_t high_ = 0x6c62272e07bb0142u;
  std::uint64_t low_ = 0x62b821756295c58du;
};

/// Reads by way of `files` and adds what was read, in the order of reading. `hash` must outlive the result.
ReadFile hashing(ReadFile files, ContentHash& hash);

}  // namespace dmvv
