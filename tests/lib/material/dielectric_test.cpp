// Glass: Fresnel reflectance at angles known on paper, refraction by Snell, what a slab lets through.
#include "lib/material/dielectric.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/random.h"
#include "lib/material/bsdf.h"

namespace tempolux {
namespace {

TEST(Fresnel, KnownAngles) {
  float cos_t;
  // ((n-1)/(n+1))^2 at normal incidence, from either side.
  EXPECT_NEAR(fresnel_dielectric(1, 1 / 1.5f, cos_t), 0.04f, 1e-6f);
  EXPECT_NEAR(fresnel_dielectric(1, 1.5f, cos_t), 0.04f, 1e-6f);
  // At Brewster's angle, tan = n, only the perpendicular half is reflected: 1/2 ((n^2-1)/(n^2+1))^2.
  const float n = 1.52f, cos_b = std::cos(std::atan(n)), r = (n * n - 1) / (n * n + 1);
  EXPECT_NEAR(fresnel_dielectric(cos_b, 1 / n, cos_t), 0.5f * r * r, 1e-6f);
  EXPECT_NEAR(std::sqrt(1 - cos_t * cos_t) * n, std::sin(std::atan(n)), 1e-6f);  // Snell
  // Inside glass, at angles above asin(1/n), all light is reflected.
  EXPECT_EQ(fresnel_dielectric(std::cos(std::asin(1 / n) + 0.01f), n, cos_t), 1.0f);
  EXPECT_NEAR(fresnel_dielectric(1e-6f, 1 / n, cos_t), 1.0f, 1e-4f);
}

Material glass(bool thin, float transmission = 1) {
  Material material;
  material.base_color = Rgb(1.0f, 0.5f, 0.25f);
  material.metallic = 0;
  material.roughness = 0;
  material.ior = 1.52f;
  material.transmission = transmission;
  material.thin_walled = thin;
  return material;
}

/// Seen to fail: a ray that Fresnel's share chooses, weighed by this share again.
TEST(Glass, ReflectsAndRefractsInFresnelsProportionAndLosesNothing) {
  for (bool front : {true, false})
    for (float cos_o : {1.0f, 0.7f, 0.2f}) {
      const Bsdf bsdf(glass(false), front);
      EXPECT_FALSE(bsdf.has_lambert());
      EXPECT_FALSE(bsdf.has_diffuse());
      EXPECT_TRUE(bsdf.has_specular());
      const Vec3 wo{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
      const float eta = front ? 1 / 1.52f : 1.52f;
      float cos_t;
      const float expected = fresnel_dielectric(cos_o, eta, cos_t);
      int reflected = 0;
      constexpr int kSamples = 4096;
      for (int i = 0; i < kSamples; ++i) {
        const auto s = bsdf.sample(wo, (float(i) + 0.5f) / kSamples, {0.5f, 0.5f});
        EXPECT_TRUE(s.delta);
        EXPECT_FALSE(s.diffuse);
        EXPECT_NEAR(length(s.wi), 1, 1e-5f);
        reflected += !s.transmitted;
        if (s.transmitted) {
          EXPECT_NEAR(s.wi.x, -eta * wo.x, 1e-5f);
          EXPECT_LT(s.wi.z, 0);
          EXPECT_EQ(s.weight, Rgb(1.0f, 0.5f, 0.25f));
        } else {
          EXPECT_EQ(s.weight, Rgb(1.0f));
        }
      }
      EXPECT_NEAR(double(reflected) / kSamples, expected, 1.0 / kSamples + 1e-6);
    }
}

TEST(Glass, AThinWallLetsLightStraightThrough) {
  const Bsdf bsdf(glass(true));
  const Vec3 wo = normalize(Vec3{0.5f, 0.2f, 0.6f});
  const auto s = bsdf.sample(wo, 0.999f, {0.5f, 0.5f});
  ASSERT_TRUE(s.transmitted);
  EXPECT_EQ(s.wi, -wo);
}

/// A material that is half glass and half matte: the two halves share the samples, and each reflects half as much.
TEST(Glass, ShareOfTransmissionLeavesTheRestToTheMatteLobe) {
  Material material = glass(false, 0.5f);
  material.specular = 0;
  const Bsdf bsdf(material);
  const Vec3 wo{0, 0, 1};
  EXPECT_NEAR(bsdf.diffuse_reflectance(Vec3{0, 0, 1}).g, 0.25f, 1e-6f);
  double matte = 0;
  constexpr int kSamples = 1000;
  for (int i = 0; i < kSamples; ++i) {
    const auto s =
        bsdf.sample(wo, (float(i) + 0.5f) / kSamples, PathRandom(1, std::uint64_t(i)).get2(0, Purpose::test));
    if (s.diffuse) matte += double(s.weight.g);
  }
  EXPECT_NEAR(matte / kSamples, 0.25, 1e-3);
}

}  // namespace
}  // namespace tempolux
