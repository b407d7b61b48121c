// Private to authoring: work on a grid's slices, on any number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "authoring/distance_grid.h"

namespace dmvv::authoring {

/// Calls work(z) once for each z below `slices`, in any order; they must not depend on each other. `threads` 0: as many
/// as there are cores. What a call throws ends the others early and is thrown again here. Progress is told by the
/// calling thread: `before` + the slices that are done, of `total`.
inline void for_each_slice(std::uint32_t slices, unsigned threads, const std::function<void(std::uint32_t)>& work,
                           const Progress& progress, std::size_t before, std::size_t total) {
  std::atomic<std::uint32_t> next{0}, done{0};
  std::mutex lock;
  std::exception_ptr failure;
  const auto run = [&](const Progress& tell) {
    try {
      for (std::uint32_t z = next++; z < slices; z = next++) {
        work(z);
        const std::uint32_t filled = ++done;
        if (tell && filled < slices) tell(before + filled, total);
      }
    } catch (...) {
      const std::scoped_lock held(lock);
      failure = std::current_exception();
      next = slices;
    }
  };
  {
    std::vector<std::jthread> others;
    if (threads == 0) threads = std::thread::hardware_concurrency();
    try {
      while (others.size() + 1 < std::min(threads, slices)) others.emplace_back([&] { run({}); });
    } catch (const std::system_error&) {
      // The system gives no more threads: those there are do the work.
    }
    run(progress);
  }
  if (failure) std::rethrow_exception(failure);
  if (progress) progress(before + slices, total);
}

/// The results for each of n numbers, computed on all cores; a call must not depend on another's.
template <class T>
std::vector<T> for_all(std::size_t n, const std::function<T(std::size_t)>& f) {
  constexpr std::size_t run = 64;
  std::vector<T> results(n);
  const auto some = [&](std::uint32_t part) {
    for (std::size_t i = part * run; i < std::min(n, (part + 1) * run); ++i) results[i] = f(i);
  };
  for_each_slice(static_cast<std::uint32_t>((n + run - 1) / run), 0, some, {}, 0, 0);
  return results;
}

inline glm::dvec3 step_of(const voml::Grid& grid) { return (grid.box_hi - grid.box_lo) / glm::dvec3(grid.size); }

/// Where sample (x, y, z) stands.
inline glm::dvec3 centre_of(const voml::Grid& grid, const glm::dvec3& sample) {
  return grid.box_lo + (sample + 0.5) * step_of(grid);
}

/// The box around `box` and its padding (a share of its longest side), made of cubic voxels within the cube,
/// `resolution` of them along its longest side; without values. Its corners are values that an LXN file holds exactly.
voml::Grid empty_grid(const voml::Bounds& box, std::uint32_t resolution, double padding);

}  // namespace dmvv::authoring
