#include "base/content_hash.h"

#include <fmt/format.h>

#include <utility>

namespace dmvv {

void ContentHash::add_byte(unsigned char byte) {
  low_ ^= byte;
  // Times the prime 2^88 + 0x13b, modulo 2^128, in halves; low_ * 0x13b does not fit 64 bits.
  constexpr std::uint64_t factor = 0x13b;
  const std::uint64_t bottom = (low_ & 0xffffffffu) * factor;
  const std::uint64_t middle = (low_ >> 32) * factor + (bottom >> 32);
  high_ = high_ * factor + (middle >> 32) + (low_ << 24);
  low_ = middle << 32 | (bottom & 0xffffffffu);
}

void ContentHash::add(std::string_view bytes) {
  for (const char c : bytes) add_byte(static_cast<unsigned char>(c));
  for (int shift = 0; shift < 64; shift += 8)
    add_byte(static_cast<unsigned char>(std::uint64_t{bytes.size()} >> shift));
}

std::string ContentHash::digits() const { return fmt::format("{:016x}{:016x}", high_, low_); }

std::string ContentHash::text() const { return "fnv1a-128:" + digits(); }

ReadFile hashing(ReadFile files, ContentHash& hash) {
  return [files = std::move(files), &hash](const std::string& path, std::uint64_t max_bytes) {
    auto bytes = files(path, max_bytes);
    if (bytes) hash.add(*bytes);
    return bytes;
  };
}

}  // namespace dmvv
