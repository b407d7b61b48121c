// Where hostile input is stopped; spec/voml.md section 8.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dmvv {

inline constexpr std::uint64_t max_file_bytes = 0xffffffffu;  ///< so that every place in it fits a Span
inline constexpr std::size_t max_element_depth = 4096;
inline constexpr std::size_t max_elements = std::size_t{1} << 20;
inline constexpr std::size_t max_documents = 4096;
inline constexpr std::size_t max_function_blocks = 256;                    ///< FUNCTIONS that one SDF may use,
inline constexpr std::size_t max_helper_bytes = std::size_t{1} << 24;      ///< their text,
inline constexpr std::size_t max_all_helper_bytes = std::size_t{1} << 25;  ///< and that of all SDFs together
inline constexpr std::size_t max_seeds = std::size_t{1} << 24;
inline constexpr std::uint32_t max_index_edge = 1024;
inline constexpr std::uint64_t max_index_cells = std::uint64_t{1} << 24;
inline constexpr std::uint32_t max_bitmap_edge = 1024;

}  // namespace dmvv
