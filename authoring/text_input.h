// Private to authoring: a file's text as the readers of molecules, tables and packings take it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/diagnostics.h"

namespace dmvv::authoring {

/// Registers a file's text so that places can point into it: without a byte order mark, and with LF for each CR that no
/// LF follows, the line end of some old programs.
///
/// Errors: `syntax` where the file is 4 GiB or longer, packed by gzip, or UTF-16; then nothing. Cost: a copy.
std::optional<SourceId> add_text(const std::string& path, std::string_view bytes, Code syntax,
                                 Diagnostics& diagnostics);

/// The end of a message about a text that is no number: "; write 1.5, with a point" where a decimal comma is the cause,
/// else nothing.
std::string decimal_point_hint(std::string_view text);

}  // namespace dmvv::authoring
