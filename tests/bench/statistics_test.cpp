// Statistics against values worked out by hand.
#include "bench/statistics.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace dmvv::bench;
using doctest::Approx;

TEST_CASE("quantiles lie between order statistics") {
  CHECK(median({3.0, 1.0, 2.0}) == 2.0);
  CHECK(median({4.0, 1.0, 3.0, 2.0}) == 2.5);
  CHECK(median({7.0}) == 7.0);
  // Type 7: place 0.95 * 4 = 3.8 between the 4th and 5th of 5 values.
  CHECK(quantile({10.0, 20.0, 30.0, 40.0, 50.0}, 0.95) == Approx(48.0));
  CHECK(quantile({10.0, 20.0}, 0.0) == 10.0);
  CHECK(quantile({10.0, 20.0}, 1.0) == 20.0);
  CHECK(std::isnan(median({})));
}

TEST_CASE("the median absolute deviation ignores one outlier") {
  CHECK(mad({1.0, 2.0, 3.0, 4.0, 100.0}) == 1.0);  // deviations 2 1 0 1 97
  CHECK(mad({5.0, 5.0, 5.0}) == 0.0);
  // 1.4826 * 1 * sqrt(pi / 2 / 5)
  CHECK(median_error({1.0, 2.0, 3.0, 4.0, 100.0}) == Approx(0.830993).epsilon(1e-4));
}

TEST_CASE("a power law is found again") {
  const std::vector<double> x{1.0, 2.0, 4.0, 8.0};
  const std::vector<double> cube{5.0, 40.0, 320.0, 2560.0};  // 5 x^3
  const auto law = fit_power_law(x, cube);
  REQUIRE(law);
  CHECK(law->exponent == Approx(3.0));
  CHECK(law->factor == Approx(5.0));
  CHECK(law->r2 == Approx(1.0));
  CHECK(law->count == 4);
  // Least squares in log2: (0, 0) (1, 1) (2, 0) has slope 0 and does not explain anything.
  const std::vector<double> x3{1.0, 2.0, 4.0}, bump{1.0, 2.0, 1.0};
  CHECK(fit_power_law(x3, bump)->exponent == Approx(0.0));
  CHECK(fit_power_law(x3, bump)->r2 == Approx(0.0));
}

TEST_CASE("points without a logarithm are left out") {
  const std::vector<double> x{1.0, 2.0, 4.0, 8.0, 16.0}, y{3.0, 0.0, 48.0, NAN, -1.0};
  const auto law = fit_power_law(x, y);
  REQUIRE(law);
  CHECK(law->count == 2);
  CHECK(law->exponent == Approx(2.0));
  const std::vector<double> same{2.0, 2.0}, any{1.0, 3.0};
  CHECK_FALSE(fit_power_law(same, any));
  CHECK_FALSE(fit_power_law({}, {}));
}

TEST_CASE("the Pareto front holds what nothing beats") {
  const std::vector<CostError> points{{3.0, 1.0}, {1.0, 5.0}, {2.0, 5.0}, {2.0, 3.0},
                                      {4.0, 2.0}, {5.0, NAN}, {2.0, 3.0}};
  CHECK(pareto_front(points) == std::vector<std::size_t>{1, 3, 0});
}
