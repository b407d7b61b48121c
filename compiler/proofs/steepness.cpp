#include "compiler/proofs/steepness.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "base/parallel.h"
#include "compiler/grids/grid_bounds.h"
#include "compiler/grids/storage.h"
#include "compiler/snippet/time_range.h"
#include "compiler/snippet/time_values.h"

namespace dmvv::compiler {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double near_share = 1.0 / 64.0, middle_share = 1.0 / 8.0;  ///< of the largest |value - iso|: where bands end

/// The largest slope of each band.
class Bands {
 public:
  /// `largest`: |value - iso|; `error`: what a value may be off.
  Bands(double iso, double largest, double error) : iso_(iso), error_(error) {
    steepness_.widths = {near_share * largest, middle_share * largest};
    steepness_.error = error;
  }

  /// Of a place whose values lie in [lo, hi], what a value may be off apart.
  void add(double lo, double hi, double slope) {
    const double from = std::max({lo - iso_, iso_ - hi, 0.0}) - error_;
    const double to = std::max(hi - iso_, iso_ - lo) + error_;
    for (std::size_t band = 0; band < 3; ++band) {
      const double begin = band == 0 ? 0.0 : steepness_.widths[band - 1];
      const double end = band == 2 ? infinity : steepness_.widths[band];
      if (from <= end && to >= begin) steepness_.slopes[band] = std::max(steepness_.slopes[band], slope);
    }
  }
  void add(const Bands& other) {
    for (std::size_t band = 0; band < 3; ++band)
      steepness_.slopes[band] = std::max(steepness_.slopes[band], other.steepness_.slopes[band]);
  }
  const Steepness& steepness() const { return steepness_; }

 private:
  double iso_, error_;
  Steepness steepness_;
};

/// Adds the voxels between samples z and z + 1. A derivative along an axis lies between the differences along the four
/// edges.
void add_voxels(const voml::Grid& grid, const glm::vec3& samples_per_unit, std::size_t z, std::vector<Bands>& bands) {
  const std::size_t nx = grid.size.x, ny = grid.size.y, nz = grid.size.z;
  const std::size_t right = nx > 1 ? 1 : 0, up = ny > 1 ? nx : 0, back = z + 1 < nz ? nx * ny : 0;
  const auto difference = [&](const float* v, std::size_t along, std::size_t a, std::size_t b) {
    const auto edge = [&](std::size_t offset) { return std::abs(v[offset + along] - v[offset]); };
    return std::max(std::max(edge(0), edge(a)), std::max(edge(b), edge(a + b)));
  };
  constexpr double rounding = 1.0 + 1e-5;  // computed in float
  for (std::size_t y = 0; y + (ny > 1 ? 1 : 0) < ny; ++y) {
    const float* row = grid.values.data() + (z * ny + y) * nx;
    for (std::size_t x = 0; x + right < nx; ++x) {
      const float* const v = row + x;
      const glm::vec3 g =
          glm::vec3(difference(v, right, up, back), difference(v, up, right, back), difference(v, back, right, up)) *
          samples_per_unit;
      const auto [lo, hi] = std::minmax(
          {v[0], v[right], v[up], v[right + up], v[back], v[right + back], v[up + back], v[right + up + back]});
      const double slope = rounding * std::sqrt(static_cast<double>(glm::dot(g, g)));
      for (Bands& of_iso : bands) of_iso.add(lo, hi, slope);
    }
  }
}

std::vector<Steepness> unknown(std::size_t count) {
  return std::vector<Steepness>(count, Steepness{{}, {infinity, infinity, infinity}, 0.0});
}

/// For each iso.
std::vector<Steepness> grid_steepness(const voml::Grid& grid, const std::vector<double>& isos, TexelFormat format,
                                      Filter filter) {
  if (format != TexelFormat::r32f) return unknown(isos.size());  // rounded texels make other slopes
  const GridBounds bounds = grid_bounds(grid);
  const glm::dvec3 samples_per_unit = glm::dvec3(grid.size) / (grid.box_hi - grid.box_lo);
  const double slack = filter_error(bounds, bounds.magnitude, format, filter);
  const double lookup = glm::dot(bounds.slope, sample_error(grid, glm::dvec3(0.0)));
  const double largest_factor = filter == Filter::tricubic ? tricubic_slope : 1.0;
  std::vector<Bands> bands;
  for (const double iso : isos)
    bands.emplace_back(iso, bounds.magnitude + std::abs(iso), slack + largest_factor * lookup);
  if (filter == Filter::tricubic) {
    for (Bands& of_iso : bands)
      of_iso.add(-infinity, infinity, tricubic_slope * glm::length(bounds.slope * samples_per_unit));
  } else {
    std::vector<std::vector<Bands>> of_slices(std::max(grid.size.z, 2u) - 1, bands);
    in_parallel(of_slices.size(), [&](std::size_t z) { add_voxels(grid, samples_per_unit, z, of_slices[z]); });
    for (const std::vector<Bands>& of_slice : of_slices) {
      for (std::size_t i = 0; i < bands.size(); ++i) bands[i].add(of_slice[i]);
    }
  }
  std::vector<Steepness> result;
  for (const Bands& of_iso : bands) result.push_back(of_iso.steepness());
  return result;
}

std::vector<Steepness> function_steepness(const snippet::Snippet& function, const std::vector<double>& isos) {
  constexpr int boxes = 8;  ///< along an axis
  constexpr std::size_t most_instructions = 2000;
  const snippet::Interval always{-longest_ms, longest_ms};
  const snippet::Box cube{glm::dvec3(-1.0), glm::dvec3(1.0)};
  const snippet::Steepness whole = function.steepness(cube, always);
  const snippet::BoxFunction value(function, always);
  const snippet::Interval range = value(cube);
  const double largest = std::max(std::abs(range.lo), std::abs(range.hi));
  std::vector<Bands> bands;
  for (const double iso : isos) bands.emplace_back(iso, largest < 1e6 ? largest + std::abs(iso) : 4.0, whole.error);
  const std::size_t size = function.time_split().residual.instructions.size();
  if (size > most_instructions) {
    for (Bands& of_iso : bands) of_iso.add(-infinity, infinity, whole.slope);
  } else {
    struct Part {
      snippet::Interval range{};
      double slope = 0.0;
    };
    std::vector<Part> parts(boxes * boxes * boxes);
    in_parallel(parts.size(), [&](std::size_t i) {
      const std::size_t row = i / boxes, slice = row / boxes;
      const glm::dvec3 corner(double(i % boxes), double(row % boxes), double(slice));
      const glm::dvec3 lo = corner * (2.0 / boxes) - 1.0;
      const snippet::Box box{lo, lo + 2.0 / boxes};
      parts[i] = {value(box), function.steepness(box, always).slope};
    });
    for (const Part& part : parts) {
      const bool is_known = part.range.lo <= part.range.hi;
      for (Bands& of_iso : bands)
        of_iso.add(is_known ? part.range.lo : -infinity, is_known ? part.range.hi : infinity,
                   std::min(part.slope, whole.slope));
    }
  }
  std::vector<Steepness> result;
  for (const Bands& of_iso : bands) result.push_back(of_iso.steepness());
  return result;
}

/// The isos at which a source is asked, and by which SDFs.
using Isos = std::map<double, std::vector<std::size_t>>;

}  // namespace

double Steepness::distance(double value) const {
  const double u = value - error;
  return std::min(u, widths[0]) / slopes[0] + std::clamp(u - widths[0], 0.0, widths[1] - widths[0]) / slopes[1] +
         std::max(u - widths[1], 0.0) / slopes[2];
}

float flatness(double slope) { return static_cast<float>((1.0 - 1e-6) / std::clamp(slope, 1e-30, 1e30)); }

std::vector<Steepness> source_steepness(const Module& module, TexelFormat format, Filter filter) {
  std::vector<Isos> of_grids(module.grids.size()), of_functions(module.functions.size());
  for (std::size_t i = 0; i < module.sdfs.size(); ++i) {
    const Sdf& sdf = module.sdfs[i];
    const auto* function = std::get_if<Id<Function>>(&sdf.source);
    Isos& isos = function ? of_functions[function->index] : of_grids[std::get<Id<voml::Grid>>(sdf.source).index];
    isos[sdf.iso].push_back(i);
  }
  std::vector<Steepness> result(module.sdfs.size());
  const auto put = [&](const Isos& asked, const auto& steepness_of) {
    std::vector<double> isos;
    for (const auto& [iso, sdfs] : asked) isos.push_back(iso);
    if (isos.empty()) return;
    const std::vector<Steepness> found = steepness_of(isos);
    std::size_t next = 0;
    for (const auto& [iso, sdfs] : asked) {
      for (const std::size_t sdf : sdfs) result[sdf] = found[next];
      ++next;
    }
  };
  for (std::size_t i = 0; i < of_grids.size(); ++i)
    put(of_grids[i], [&](const auto& isos) { return grid_steepness(module.grids[i], isos, format, filter); });
  for (std::size_t i = 0; i < of_functions.size(); ++i)
    put(of_functions[i], [&](const auto& isos) { return function_steepness(module.functions[i].snippet, isos); });
  return result;
}

}  // namespace dmvv::compiler
