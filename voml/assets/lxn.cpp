// The distance grid format LXN, spec/lxn.md. Thesis appendix B.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <new>

#include "voml/assets/grid.h"

namespace dmvv::voml {
namespace {

constexpr std::size_t header_bytes = 128;
constexpr std::string_view magic{"LXN\0", 4};
// Byte offsets of the header's fields.
constexpr std::size_t at_channel_type = 4, at_dimension = 8, at_channels = 12, at_size = 16, at_address_mode = 56,
                      at_has_box = 60, at_box_lo = 64, at_box_hi = 76;

std::uint32_t load_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  return value;
}
std::int32_t load_i32(std::string_view bytes, std::size_t at) { return static_cast<std::int32_t>(load_u32(bytes, at)); }
float load_f32(std::string_view bytes, std::size_t at) { return std::bit_cast<float>(load_u32(bytes, at)); }

void store(std::string& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>((value >> (8 * i)) & 0xffu);
}
void store(std::string& bytes, std::size_t at, std::int32_t value) {
  store(bytes, at, static_cast<std::uint32_t>(value));
}
void store(std::string& bytes, std::size_t at, float value) { store(bytes, at, std::bit_cast<std::uint32_t>(value)); }

/// One reading of one file: fills `grid`, reports the first fault of each kind.
class Reader {
 public:
  Reader(std::string_view bytes, SourceId where, Diagnostics& diagnostics)
      : bytes_(bytes), where_(where), diagnostics_(diagnostics) {}

  bool read(Grid& grid) { return read_header(grid) && read_size(grid) && read_box(grid) && read_values(grid); }

 private:
  bool refuse(Code code, std::string message) {
    diagnostics_.report(code, Span{where_, 0, 0}, std::move(message));
    return false;
  }

  bool refuse_magic() {
    std::string found;
    for (const char c : bytes_.substr(0, magic.size())) found += fmt::format(" {:02x}", static_cast<unsigned char>(c));
    return refuse(Code::lxn_header, fmt::format("the magic is{}, it must be 4c 58 4e 00 ('LXN' and a zero)",
                                                found.empty() ? " missing" : found));
  }

  bool expect(std::string_view field, std::size_t at, std::int32_t wanted) {
    const std::int32_t found = load_i32(bytes_, at);
    return found == wanted ||
           refuse(Code::lxn_header, fmt::format("the {} is {}, it must be {}", field, found, wanted));
  }

  bool read_header(Grid& grid) {
    if (!bytes_.starts_with(magic)) return refuse_magic();
    if (bytes_.size() < header_bytes) {
      return refuse(Code::lxn_header,
                    fmt::format("the header has {} bytes, but the file only {}", header_bytes, bytes_.size()));
    }
    if (!expect("dimension", at_dimension, 3) || !expect("number of channels", at_channels, 1)) return false;
    grid.channel_type = load_i32(bytes_, at_channel_type);
    const std::int32_t mode = load_i32(bytes_, at_address_mode);
    if (mode < 0 || mode > 2) {
      diagnostics_.report(Code::lxn_address_mode, Span{where_, 0, 0},
                          fmt::format("the address mode is {}, it must be 0, 1 or 2; 0 (clamp) is used", mode));
    } else {
      grid.address_mode = AddressMode{mode};
    }
    return true;
  }

  bool read_size(Grid& grid) {
    const std::int32_t size[3] = {load_i32(bytes_, at_size), load_i32(bytes_, at_size + 4),
                                  load_i32(bytes_, at_size + 8)};
    const std::string text = fmt::format("{} x {} x {}", size[0], size[1], size[2]);
    for (const std::int32_t edge : size) {
      if (edge < 1)
        return refuse(Code::lxn_size, fmt::format("the size is {}, each of the three must be at least 1", text));
    }
    const std::uint64_t held = (bytes_.size() - header_bytes) / sizeof(float);
    const std::uint64_t plane = std::uint64_t(size[0]) * std::uint64_t(size[1]);  // < 2^62
    const bool too_large = plane > held / std::uint64_t(size[2]);
    if (too_large || plane * std::uint64_t(size[2]) != held || (bytes_.size() - header_bytes) % sizeof(float) != 0) {
      const double wanted = double(plane) * size[2] * sizeof(float);
      return refuse(Code::lxn_size, fmt::format("the size {} needs {:.0f} bytes after the header, but the file has {}",
                                                text, wanted, bytes_.size() - header_bytes));
    }
    grid.size = {size[0], size[1], size[2]};
    return true;
  }

  /// Empty if an edge of the box can be used: also as float32 in the standard cube, where shaders have it.
  static std::string_view box_fault(float lo, float hi) {
    if (!std::isfinite(lo) || !std::isfinite(hi)) return "not finite";
    if (!(lo < hi)) return "empty or reversed";
    const auto cube_lo = static_cast<float>(2.0 * double{lo} - 1.0),
               cube_hi = static_cast<float>(2.0 * double{hi} - 1.0);
    if (!std::isfinite(cube_lo) || !std::isfinite(cube_hi)) return "beyond the range of float32";
    if (!(cube_lo < cube_hi)) return "thinner than float32 can tell";
    return {};
  }

  bool read_box(Grid& grid) {
    const std::int32_t has_box = load_i32(bytes_, at_has_box);
    if (has_box == 0) return true;
    if (has_box != 1) {
      return refuse(Code::lxn_header, fmt::format("the bounding box flag is {}, it must be 0 or 1", has_box));
    }
    for (int i = 0; i < 3; ++i) {
      const float lo = load_f32(bytes_, at_box_lo + 4 * static_cast<std::size_t>(i));
      const float hi = load_f32(bytes_, at_box_hi + 4 * static_cast<std::size_t>(i));
      grid.box_lo[i] = 2.0 * double{lo} - 1.0;
      grid.box_hi[i] = 2.0 * double{hi} - 1.0;
      if (const std::string_view why = box_fault(lo, hi); !why.empty()) {
        return refuse(Code::lxn_box,
                      fmt::format("the bounding box is {} along {}: it goes from {} to {}", why, "xyz"[i], lo, hi));
      }
    }
    return true;
  }

  bool read_values(Grid& grid) {
    grid.values.resize((bytes_.size() - header_bytes) / sizeof(float));
    if constexpr (std::endian::native == std::endian::little) {
      std::memcpy(grid.values.data(), bytes_.data() + header_bytes, grid.values.size() * sizeof(float));
    } else {
      for (std::size_t i = 0; i < grid.values.size(); ++i) grid.values[i] = load_f32(bytes_, header_bytes + 4 * i);
    }
    for (std::size_t i = 0; i < grid.values.size(); ++i) {
      if (std::isfinite(grid.values[i])) continue;
      const std::size_t x = i % grid.size.x, y = i / grid.size.x % grid.size.y, z = i / grid.size.x / grid.size.y;
      return refuse(Code::lxn_value, fmt::format("value {} (x {}, y {}, z {}) is {}", i, x, y, z, grid.values[i]));
    }
    return true;
  }

  std::string_view bytes_;
  SourceId where_;
  Diagnostics& diagnostics_;
};

}  // namespace

std::optional<Grid> parse_lxn(std::string_view bytes, SourceId where, Diagnostics& diagnostics) {
  try {
    Grid grid;
    grid.path = diagnostics.source_name(where);
    if (!Reader(bytes, where, diagnostics).read(grid)) return std::nullopt;
    return grid;
  } catch (const std::bad_alloc&) {
    diagnostics.report(Code::lxn_size, Span{where, 0, 0}, "there is not enough memory for the values");
    return std::nullopt;
  }
}

std::string write_lxn(const Grid& grid) {
  std::string bytes(header_bytes + grid.values.size() * sizeof(float), '\0');
  bytes.replace(0, magic.size(), magic);
  store(bytes, at_channel_type, grid.channel_type);
  store(bytes, at_dimension, 3);
  store(bytes, at_channels, 1);
  store(bytes, at_address_mode, static_cast<std::int32_t>(grid.address_mode));
  store(bytes, at_has_box, 1);
  for (int i = 0; i < 3; ++i) {
    const std::size_t offset = 4 * static_cast<std::size_t>(i);
    store(bytes, at_size + offset, grid.size[i]);
    store(bytes, at_box_lo + offset, static_cast<float>((grid.box_lo[i] + 1.0) / 2.0));
    store(bytes, at_box_hi + offset, static_cast<float>((grid.box_hi[i] + 1.0) / 2.0));
  }
  for (std::size_t i = 0; i < grid.values.size(); ++i) store(bytes, header_bytes + 4 * i, grid.values[i]);
  return bytes;
}

}  // namespace dmvv::voml
