// The table of rough glass's loss against the integrals that it stores.
#include <gtest/gtest.h>

#include "lib/material/glass_albedo.h"
#include "lib/material/tables/nodes.h"

namespace tempolux {
namespace {

using namespace glass_table;
using integrals::glass_loss;

/// 2 integral of the table's own values times mu dmu, mu = v^3.
double mean_of(const GlassLoss& loss, int side, const integrals::GaussLegendre& rule) {
  double sum = 0;
  for (std::size_t i = 0; i < rule.x.size(); ++i) {
    const double v = rule.x[i], mu = v * v * v;
    sum += 6 * v * v * mu * rule.weight[i] * double(loss.at(side, float(mu)));
  }
  return sum;
}

// A perfect reflector is GGX with F = 1: 1 - E = ln 2 at alpha = 1, straight on (ggx_integrals.h).
TEST(GlassReference, IsGgxForAPerfectReflector) {
  EXPECT_NEAR(glass_loss(1, 1, 1e-4, 400), std::log(2.0), 2e-3);
  for (double mu : {0.1, 0.4, 0.8})
    EXPECT_NEAR(glass_loss(mu, 0.3, 1e-6, 400), 1 - integrals::ggx_albedo(mu, 0.3, integrals::GaussLegendre(96)).total,
                2e-3);
}

// 48 x 24 normals differ from the generator's 256 x 128 by the cut at the horizon: one part in 48 of the rim.
TEST(GlassLossTable, HoldsTheIntegrals) {
  for (int i = 0; i < 2 * kPlanes * kRows * kColumns; i += 53) {
    const int column = i % kColumns, row = i / kColumns % kRows, plane = i / kColumns / kRows % kPlanes;
    const int side = i / kColumns / kRows / kPlanes;
    EXPECT_NEAR(kLoss[side][plane][row][column], node(side, plane, row, column, 64), 5e-3)
        << side << ' ' << plane << ' ' << row << ' ' << column;
  }
}

// Between the nodes. The largest error in a furnace is the bound in the header; measured 2.1e-3.
TEST(GlassLossTable, InterpolatesWithinItsBound) {
  double worst = 0;
  for (int k = 0; k < 600; ++k) {
    const double r = 0.1 + 0.9 * std::fmod(k * 0.6180339887, 1.0), index = 1.2 + 1.3 * std::fmod(k * 0.7548776662, 1.0);
    const double mu = 0.02 + 0.98 * std::fmod(k * 0.5698402910, 1.0);
    const int side = k % 2;
    const double off = double(GlassLoss(float(index), float(r * r)).at(side, float(mu))) -
                       glass_loss(mu, r * r, eta_of(side, index), 200);
    EXPECT_LT(std::abs(off), 3e-3) << side << " index " << index << " roughness " << r << " cos " << mu;
    worst = std::max(worst, std::abs(off));
  }
  RecordProperty("worst", std::to_string(worst));
}

// The mean has its own table: it must be the mean of the values of at(), otherwise the distributed light does not add
// up.
TEST(GlassLossTable, MeanIsTheMeanOfTheValues) {
  const integrals::GaussLegendre rule(200);
  for (double index : {1.1, 1.5, 2.2})
    for (double roughness : {0.1, 0.25, 0.5, 0.8, 1.0})
      for (int side : {0, 1}) {
        const GlassLoss loss(float(index), float(roughness * roughness));
        EXPECT_NEAR(loss.mean(side), mean_of(loss, side, rule), 1e-3 + 0.01 * double(loss.mean(side)))
            << index << ' ' << roughness << ' ' << side;
      }
}

}  // namespace
}  // namespace tempolux
