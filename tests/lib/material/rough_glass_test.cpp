// Rough glass: no light is lost, scattering is reciprocal, and samples are distributed by the pdf.
#include "lib/material/rough_glass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <vector>

#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/material/bsdf.h"
#include "tests/support/distribution.h"
#include "tests/support/materials.h"

namespace tempolux {
namespace {

using test::direction;
using test::glass;

class RoughGlassTest : public testing::TestWithParam<std::tuple<float, bool, bool>> {  // roughness, thin, front
 protected:
  float roughness() const { return std::get<0>(GetParam()); }
  bool thin() const { return std::get<1>(GetParam()); }
  bool front() const { return std::get<2>(GetParam()); }
};

// Energy is conserved within 0.5 %: the mean weight over 2^15 samples, for radiance and, with the same value, for
// photons. Weights are below 3 with a deviation below 0.3: 4 sigma = 0.006 for random points; Sobol points leave less
// than a quarter. The table's own bound is 0.003.
TEST_P(RoughGlassTest, ReturnsAllLight) {
  for (float index : {1.2f, 1.5f, 2.0f}) {
    const Bsdf bsdf(glass(roughness(), thin(), index), front());
    ASSERT_FALSE(bsdf.specular_is_delta());
    double over_all = 0;
    for (float c : {0.03f, 0.15f, 0.4f, 0.65f, 0.75f, 0.9f, 1.0f}) {
      double sum = 0;
      constexpr std::uint32_t kCount = 1 << 16;
      const PathRandom random(9, std::uint64_t(1000 * c));
      for (std::uint32_t i = 0; i < kCount; ++i) {
        const Bsdf::Sample s = bsdf.sample(direction(c, 0.3f), random.get1(i, Purpose::lobe), sobol_owen_2d(i, 11));
        sum += double(s.weight.g);
        ASSERT_LT(s.weight.g, 20) << c;
        ASSERT_EQ(s.transmitted, s.wi.z < 0);
      }
      EXPECT_NEAR(sum / kCount, 1, 0.005) << "index " << index << " cos " << c;
      over_all += sum / kCount / 7;
    }
    EXPECT_NEAR(over_all, 1, 0.002) << index;
  }
}

// Directions counted in 16 x 12 cells of equal cos and phi over the sphere, and the mean of the weights there against
// the integral of f cos. Chi-square: mean k - 1, variance 2 (k - 1); limit 5 sigma.
TEST_P(RoughGlassTest, SamplesFallWhereThePdfSays) {
  if (roughness() < 0.35f) return;  // narrower than a cell: the test of the mean weights covers these
  const Bsdf bsdf(glass(roughness(), thin()), front());
  for (float cos_o : {0.95f, 0.5f, 0.1f}) {
    const Vec3 wo = direction(cos_o, 0.7f);
    test::expect_samples_follow_pdf(
        bsdf, wo, std::to_string(cos_o), {.cos = 16, .phi = 12, .sub = 80, .sphere = true}, [&](const Bsdf::Sample& s) {
          const float f = bsdf.eval_specular(s.wi, wo).g;
          ASSERT_NEAR(s.weight.g, f * std::abs(s.wi.z) / s.pdf_solid_angle, 2e-3f * s.weight.g);
        });
  }
}

INSTANTIATE_TEST_SUITE_P(Glass, RoughGlassTest,
                         testing::Combine(testing::Values(0.1f, 0.25f, 0.4f, 0.7f, 1.0f), testing::Bool(),
                                          testing::Bool()));

// n_o^2 f(wi, wo) = n_i^2 f(wo, wi), seen from either side; for reflected light and thin walls f(wi, wo) = f(wo, wi).
TEST(RoughGlass, IsReciprocalForRadianceOverTheIndexSquared) {
  const PathRandom random(1, 0);
  for (bool thin : {false, true})
    for (float index : {1.3f, 1.52f, 2.4f})
      for (float roughness : {0.15f, 0.5f, 1.0f}) {
        const Bsdf outside(glass(roughness, thin, index), true), inside(glass(roughness, thin, index), false);
        const float n2 = thin ? 1 : index * index;
        for (std::uint32_t i = 0; i < 500; ++i) {
          const Vec3 a = sample_hemisphere_cos(random.get2(i, Purpose::test, 1));
          const Vec3 b = sample_hemisphere_cos(random.get2(i, Purpose::test, 2));
          const Vec3 under{b.x, b.y, -b.z}, over{a.x, a.y, -a.z};
          // Seen from outside along a, light from inside along `under`; and seen from inside along b (its own z is
          // up), light from outside along `over`.
          const float in = outside.eval_specular(under, a).g, out = inside.eval_specular({over.x, over.y, over.z}, b).g;
          EXPECT_NEAR(in, out * n2, 1e-3f * in + 1e-6f) << thin << index << roughness;
          const float ab = outside.eval_specular(a, b).g, ba = outside.eval_specular(b, a).g;
          EXPECT_NEAR(ab, ba, 1e-4f * ab + 1e-6f);
        }
      }
}

// A rough solid that gets smoother approaches the smooth one: the share transmitted at normal incidence is 1 - F, and
// all of it lies within a few alpha of Snell's direction.
TEST(RoughGlass, NarrowsToTheSmoothBoundary) {
  const Bsdf bsdf(glass(0.03f, false), true);
  const Vec3 wo = direction(0.6f, 0);
  const Vec3 snell = Vec3{-wo.x / 1.5f, 0, -std::sqrt(1 - 0.64f / 2.25f)};
  double through = 0, near = 0;
  constexpr std::uint32_t kCount = 1 << 14;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Bsdf::Sample s = bsdf.sample(wo, sobol_owen_1d(i, 7), sobol_owen_2d(i, 11));
    if (!s.transmitted) continue;
    through += double(s.weight.g);
    if (length(s.wi - snell) < 0.02f) near += double(s.weight.g);
  }
  // F(53.13 deg, 1.5) = (r_s^2 + r_p^2) / 2, r_s = (0.6 - 1.5 c) / (0.6 + 1.5 c), r_p = (0.9 - c) / (0.9 + c).
  const double c = std::sqrt(1 - 0.64 / 2.25), rs = (0.6 - 1.5 * c) / (0.6 + 1.5 * c), rp = (0.9 - c) / (0.9 + c);
  EXPECT_NEAR(through / kCount, 1 - 0.5 * (rs * rs + rp * rp), 1e-3);
  EXPECT_GT(near, 0.99 * through);
}

TEST(RoughGlass, IsFiniteAtEveryEdge) {
  const float edges[] = {1e-38f, 1e-6f, 1e-3f, 0.5f, 1};
  for (float roughness : {0.021f, 0.1f, 1.0f})
    for (float index : {0.0f, 1.0f, 1.0011f, 1.5f, 1e6f})
      for (bool thin : {false, true})
        for (bool front : {false, true}) {
          const Bsdf bsdf(glass(roughness, thin, index), front);
          for (float co : edges)
            for (float ci : edges)
              for (float sign : {1.0f, -1.0f}) {
                const Vec3 wo = direction(co, 0), w = direction(ci, 2), wi{w.x, w.y, sign * w.z};
                ASSERT_TRUE(is_finite(bsdf.eval_specular(wi, wo)) && std::isfinite(bsdf.pdf_specular(wi, wo)));
                for (const Vec3& special : {-wo, Vec3{-wo.x, -wo.y, wo.z}})
                  ASSERT_TRUE(is_finite(bsdf.eval_specular(special, wo)) &&
                              std::isfinite(bsdf.pdf_specular(special, wo)));
                for (float u : {0.0f, 0.5f, kOneMinusEpsilon}) {
                  const Bsdf::Sample s = bsdf.sample(wo, u, {u, ci});
                  ASSERT_TRUE(is_finite(s.weight) && is_finite(s.wi) && std::isfinite(s.pdf_solid_angle));
                  ASSERT_LT(max_component(s.weight), 50) << roughness << ' ' << index << thin << front << co;
                }
              }
        }
}

}  // namespace
}  // namespace tempolux
