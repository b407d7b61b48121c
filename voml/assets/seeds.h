// Inside voml: what the asset loader needs besides parse_vectors.
#pragma once

#include "voml/assets/grid.h"

namespace dmvv::voml {

/// Where vector number `index` (from 0) of a file that parse_vectors accepted stands. Cost: linear in the file.
Span vector_span(SourceId source, std::size_t index, const Diagnostics& diagnostics);

}  // namespace dmvv::voml
