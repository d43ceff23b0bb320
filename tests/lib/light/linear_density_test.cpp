// The density a (1 - x) + b x over [0, 1], normalised: samples against its distribution function.
#include "lib/light/linear_density.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

// The distribution function is (a x + (b - a) x^2 / 2) / ((a + b) / 2), and sample_linear is its inverse.
TEST(LinearDensity, SamplesInvertTheDistributionFunction) {
  for (const auto& [a, b] : {std::pair{1.0, 3.0}, {3.0, 1.0}, {0.0, 2.0}, {2.0, 0.0}, {5.0, 5.0}})
    for (const double u : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      const double x = sample_linear(a, b, u);
      EXPECT_NEAR((a * x + (b - a) * x * x / 2) / ((a + b) / 2), u, 1e-14) << a << ' ' << b << ' ' << u;
    }
}

TEST(LinearDensity, WithoutLightIsUniform) { EXPECT_EQ(sample_linear(0, 0, 0.3), 0.3); }

}  // namespace
}  // namespace tempolux
