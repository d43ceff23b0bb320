// The table of GGX's albedo against the integrals that it stores.
#include <gtest/gtest.h>

#include <algorithm>

#include "lib/material/albedo.h"
#include "lib/material/tables/nodes.h"

namespace tempolux {
namespace {

using namespace albedo_table;
using integrals::Albedo;
using integrals::GaussLegendre;

// For alpha = 1, D = 1/pi and normal incidence, u = cos h and cos_i = 2 u^2 - 1: the integral is elementary,
// E = 1 - ln 2.
TEST(GgxReference, IsOneMinusLn2ForTheRoughestSurfaceSeenStraightOn) {
  EXPECT_NEAR(integrals::ggx_albedo(1, 1, GaussLegendre(48)).total, 1 - std::log(2.0), 1e-9);
}

// Every 7th node with 96 points instead of the 128 of the generator: the quadrature differs by less than 5e-6
// where it converges slowest, at grazing angles.
TEST(GgxAlbedoTable, HoldsTheIntegrals) {
  const GaussLegendre rule(96), outer(32);
  for (int i = 0; i < kRows * kColumns; i += 7) {
    const int row = i / kColumns, column = i % kColumns;
    const Albedo e = node(row, column, rule);
    EXPECT_NEAR(kTotal[column][row], e.total, 1e-5) << row << ' ' << column;
    EXPECT_NEAR(kCosine[column][row], e.b, 2e-4) << row << ' ' << column;
  }
  for (int row = 0; row < kRows; row += 5) {
    const Albedo e = integrals::ggx_mean_albedo(alpha_of_row(double(row) / (kRows - 1)), outer, GaussLegendre(64));
    EXPECT_NEAR(kMeanA[row], e.total - e.b, 1e-5) << row;
    EXPECT_NEAR(kMeanB[row], e.b, 1e-5) << row;
  }
}

// Between the nodes, over the whole domain and closer to grazing than any node. The bounds are those of the header;
// measured 3.7e-5 and 6.6e-5.
TEST(GgxAlbedoTable, InterpolatesWithinItsBound) {
  const GaussLegendre rule(96);
  double worst_total = 0, worst_b = 0;
  for (int k = 0; k < 900; ++k) {
    const double alpha = alpha_of_row(std::fmod(k * 0.6180339887, 1.0)), position = (k + 0.5) / 900;
    const double mu = std::min(1.0, k % 2 ? cos_of_column(position, alpha) : position);
    const AlbedoPair table = GgxAlbedo(float(alpha)).at(float(mu));
    const Albedo e = integrals::ggx_albedo(mu, alpha, rule);
    worst_total = std::max(worst_total, std::abs(table.a + table.b - e.total));
    worst_b = std::max(worst_b, std::abs(table.b - e.b));
  }
  RecordProperty("worst_total", std::to_string(worst_total));
  RecordProperty("worst_b", std::to_string(worst_b));
  EXPECT_LT(worst_total, 5e-5);
  EXPECT_LT(worst_b, 8e-5);
}

// The table has a column for the mean. It must be the mean of the values of at(), or the coupling of the Lambert lobe
// would not conserve energy. Tolerance 3e-5: both are interpolated.
TEST(GgxAlbedoTable, MeanIsTheMeanOfTheValues) {
  const GaussLegendre rule(200);
  for (double alpha : {4e-4, 1e-3, 7e-3, 0.03, 0.1, 0.27, 0.5, 0.77, 1.0}) {
    const GgxAlbedo albedo{float(alpha)};
    double a = 0, b = 0;
    for (std::size_t i = 0; i < rule.x.size(); ++i) {
      const double v = rule.x[i], mu = v * v, weight = 4 * v * v * v * rule.weight[i];
      a += weight * albedo.at(float(mu)).a;
      b += weight * albedo.at(float(mu)).b;
    }
    EXPECT_NEAR(albedo.mean().a, a, 3e-5) << alpha;
    EXPECT_NEAR(albedo.mean().b, b, 3e-5) << alpha;
  }
}

}  // namespace
}  // namespace tempolux
