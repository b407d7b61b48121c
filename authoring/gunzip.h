// Files packed by gzip, as the archives of molecules and packings hand them out.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/result.h"

namespace dmvv::authoring {

/// More than this is not unpacked: a kilobyte may claim to hold a megabyte, a megabyte a gigabyte.
inline constexpr std::size_t max_unpacked_bytes = std::size_t{1} << 30;

/// Whether the bytes begin as gzip's do.
bool is_gzip(std::string_view bytes);

/// What a gzip file holds: one member, or several one behind the other.
/// Errors (input): damaged or cut short, with the offset; more than `max_bytes`. Source: RFC 1952, by zlib.
Result<std::string> gunzip(std::string_view bytes, std::size_t max_bytes = max_unpacked_bytes);

}  // namespace dmvv::authoring
