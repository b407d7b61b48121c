// Numbers about numbers: medians and their noise, power laws, Pareto fronts. Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace dmvv::bench {

/// The q-quantile, 0 <= q <= 1, interpolated linearly between order statistics (Hyndman and Fan 1996, type 7).
/// NaN for no values.
double quantile(std::vector<double> values, double q);
double median(std::vector<double> values);

/// Median absolute deviation from the median, not scaled. One slow frame in ten does not move it.
double mad(const std::vector<double>& values);

/// Standard error of the median of values whose spread is `mad`: 1.4826 mad estimates the standard deviation of a
/// normal distribution, and the median's variance is pi/2 times the mean's.
double median_error(const std::vector<double>& values);

/// y = factor * x^exponent
struct PowerLaw {
  double exponent;
  double factor;
  double r2;          ///< of the logarithms; 1 where all points lie on the line
  std::size_t count;  ///< points that were used
};

/// Least squares in the logarithms. Points that are not positive and finite are left out; empty if fewer than two
/// different x remain.
std::optional<PowerLaw> fit_power_law(std::span<const double> x, std::span<const double> y);

struct CostError {
  double cost;
  double error;
};

/// Indices of the points that no other point beats in both cost and error, by ascending cost. Of equal points the first
/// is kept; points that are not finite are left out.
std::vector<std::size_t> pareto_front(std::span<const CostError> points);

}  // namespace dmvv::bench
