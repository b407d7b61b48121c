// Inside the runtime only: sines for devices whose own are too coarse.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace dmvv::runtime {

/// A kernel's SPIR-V with every sin, cos and tan of a 32-bit float written out in sums and products, each good to 2^-21
/// + 2^-24 |x| for |x| <= 1e7, as spec/accuracy.md assumes. Vulkan asks for no more than 2^-11 between -pi and pi. In:
/// SPIR-V as the compiler makes it, valid. Cost: some 40 instructions for each. Source: argument reduction in parts,
/// Cody and Waite 1980, "Software Manual for the Elementary Functions"; Taylor's series.
std::vector<std::uint32_t> with_own_sines(std::span<const std::uint32_t> words);

}  // namespace dmvv::runtime
