#include "cli/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "base/files.h"

namespace dmvv::cli {
namespace {

namespace fs = std::filesystem;

std::optional<std::uint32_t> parse_number(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

using Crc = std::uint32_t;

constexpr std::array<Crc, 256> make_crc_table() {
  std::array<Crc, 256> table{};
  for (Crc i = 0; i < 256; ++i) {
    table[i] = i;
    for (int bit = 0; bit < 8; ++bit) table[i] = (table[i] >> 1) ^ ((table[i] & 1) ? 0xedb88320u : 0u);
  }
  return table;
}

Crc crc_of(std::string_view bytes) {
  static constexpr std::array<Crc, 256> table = make_crc_table();
  Crc crc = 0xffffffffu;
  for (const char c : bytes) crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xff] ^ (crc >> 8);
  return ~crc;
}

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char c : bytes.substr(0, 4)) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

/// Takes the chunk that `rest` begins with away: its four letters and data; nothing if it is cut short or damaged.
std::optional<std::string_view> take_chunk(std::string_view& rest) {
  constexpr std::size_t frame_bytes = 12;  // length, letters, checksum
  if (rest.size() < frame_bytes) return std::nullopt;
  const std::size_t length = big_endian(rest);
  if (length > rest.size() - frame_bytes) return std::nullopt;
  const std::string_view chunk = rest.substr(4, 4 + length);
  if (crc_of(chunk) != big_endian(rest.substr(8 + length))) return std::nullopt;
  rest.remove_prefix(frame_bytes + length);
  return chunk;
}

bool is_header_of(std::string_view chunk, glm::uvec2 size_px) {
  return chunk.size() == 4 + 13 && chunk.starts_with("IHDR") && big_endian(chunk.substr(4)) == size_px.x &&
         big_endian(chunk.substr(8)) == size_px.y && chunk[12] == 8 && chunk[13] == 6;  // 8 bits, RGB and alpha
}

}  // namespace

Result<FrameRange> parse_frame_range(std::string_view text, std::uint32_t count) {
  const std::size_t dash = text.find('-');
  const auto first = parse_number(text.substr(0, dash));
  const auto last = dash == std::string_view::npos ? first : parse_number(text.substr(dash + 1));
  if (!first || !last) {
    return fail(Fault::input, fmt::format("cannot read '{}'", text), {"write FIRST-LAST, both included, as in 0-99"});
  }
  if (*first > *last) return fail(Fault::input, fmt::format("{} comes after {}", *first, *last));
  if (*last >= count) {
    return fail(Fault::input, fmt::format("there is no frame {}", *last),
                {fmt::format("the frames are 0 to {}", count - 1)});
  }
  return FrameRange{*first, *last};
}

Result<FrameNames> FrameNames::parse(const std::string& path) {
  const auto refuse = [&](std::string_view why) {
    return fail(Fault::input, fmt::format("cannot name frames by '{}': {}", path, why),
                {"use a name like frames_%04d.png"});
  };
  const fs::path target(path);
  FrameNames names;
  names.folder_ = target.has_parent_path() ? target.parent_path().string() : ".";
  names.pattern_ = target.filename().string();
  if (!path.ends_with(".png")) return refuse("frames are .png files");

  bool found = false;
  const std::string& pattern = names.pattern_;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    std::string& side = found ? names.after_ : names.before_;
    if (pattern[i] != '%' || pattern.compare(i, 2, "%%") == 0) {
      side += pattern[i];
      i += pattern[i] == '%';
      continue;
    }
    const std::size_t end = std::min(pattern.find_first_not_of("0123456789", i + 1), pattern.size());
    const std::string_view digits = std::string_view(pattern).substr(i + 1, end - i - 1);
    if (end == pattern.size() || pattern[end] != 'd')
      return refuse("only %d, with digits as in %04d, can be filled in");
    if (found) return refuse("it has two numbers");
    const auto width = digits.empty() ? 0u : parse_number(digits);
    if (!width || *width > 9) return refuse("a number has 9 digits at most");
    names.digits_ = static_cast<int>(*width);
    names.zeros_ = digits.starts_with('0');
    found = true;
    i = end;
  }
  if (!found) return refuse("the number of the frame is missing");
  return names;
}

std::string FrameNames::name(std::uint32_t frame) const {
  const std::string number = zeros_ ? fmt::format("{:0{}}", frame, digits_) : fmt::format("{:{}}", frame, digits_);
  return before_ + number + after_;
}

std::optional<std::uint32_t> FrameNames::frame_of(std::string_view text) const {
  if (text.size() <= before_.size() + after_.size() || !text.starts_with(before_) || !text.ends_with(after_)) {
    return std::nullopt;
  }
  std::string_view number = text.substr(before_.size(), text.size() - before_.size() - after_.size());
  number.remove_prefix(std::min(number.find_first_not_of(' '), number.size()));
  const auto frame = parse_number(number);
  return frame && name(*frame) == text ? frame : std::nullopt;
}

bool is_whole_frame(const std::string& path, glm::uvec2 size_px) {
  constexpr std::string_view signature = "\x89PNG\r\n\x1a\n";
  const std::uint64_t most_bytes = std::uint64_t{8} * size_px.x * size_px.y + (1u << 20);  // twice the bare pixels
  const auto bytes = disk_files()(path, most_bytes);
  if (!bytes || !bytes->starts_with(signature)) return false;
  std::string_view rest = *bytes;
  rest.remove_prefix(signature.size());
  auto chunk = take_chunk(rest);
  if (!chunk || !is_header_of(*chunk, size_px)) return false;
  while (chunk && !chunk->starts_with("IEND")) chunk = take_chunk(rest);
  return chunk && rest.empty();
}

}  // namespace dmvv::cli
