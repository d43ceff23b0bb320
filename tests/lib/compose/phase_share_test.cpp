// Light of a peaked phase function, divided between photons and camera rays.
#include "lib/compose/phase_share.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

/// Integral over the sphere of f(q) / 4 pi, q = 4 pi p(theta), with mu = cos(theta) drawn from p as a function of a
/// uniform number xi: dmu/2 = dxi / q.
template <class F>
double over_sphere(float g, const F& f) {
  constexpr int steps = 200000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const float m = sample_hg_one_minus_cos(g, (float(i) + 0.5f) / float(steps)), q = 4 * kPi * pdf_hg(g, m);
    sum += f(q) / double(q);
  }
  return sum / steps;
}

/// In uniform light every phase function scatters as isotropic scattering does, so the two parts add up to 1. The
/// photons' part is the mean of q share(q), the rays' part the mean of 1 - share(q) over directions drawn from the
/// phase function. Quadrature where q is small: 1e-3.
TEST(PhaseShare, PartsAddUp) {
  for (const float g : {-0.9f, 0.75f, 0.9f, 0.99f})
    for (const int rays : {4, 16, 64}) {
      const PhaseShare share(g, rays);
      ASSERT_TRUE(g != 0.75f || rays < 16 || share.has_rays());
      const double photons = over_sphere(g, [&](float q) { return double(q * share.of_photons(q)); });
      const double brought = over_sphere(g, [&](float q) { return double(q * share.of_rays(q)); });
      EXPECT_NEAR(photons + brought, 1, 1e-3) << g << ' ' << rays;
    }
}

/// The mean square of a photon's unshared weight is (1 + g^2) / (1 - g^2)^2, which is 50.1 at g = .9: 50 such photons
/// have the noise of one isotropic photon. (Sum over l of (2 l + 1) g^(2 l), from the phase function's Legendre moments
/// g^l.) With the share it is at most n / m = 16, because q share <= n / m and its mean is at most 1.
TEST(PhaseShare, NoPhotonCountsForMany) {
  const double alone = over_sphere(0.9f, [](float q) { return double(q) * double(q); });
  EXPECT_NEAR(alone, 1.81 / (0.19 * 0.19), 0.05);
  const PhaseShare share(0.9f, 16);
  const double shared =
      over_sphere(0.9f, [&](float q) { return double(q * share.of_photons(q)) * double(q * share.of_photons(q)); });
  EXPECT_LT(shared, 256.0 / 16);
  EXPECT_LT(shared, alone / 10);
}

/// Without a peak photons contribute all light: 16 rays pay from (1 + g) / (1 - g)^2 = 16 on, g = .672.
TEST(PhaseShare, EvenScatteringNeedsNoRays) {
  for (const float g : {0.0f, 0.5f, -0.5f, 0.66f}) {
    EXPECT_FALSE(PhaseShare(g, 16).has_rays()) << g;
    EXPECT_EQ(PhaseShare(g, 16).of_photons(3), 1) << g;
  }
  EXPECT_TRUE(PhaseShare(0.69f, 16).has_rays());
  EXPECT_FALSE(PhaseShare(0.99f, 0).has_rays());
}

}  // namespace
}  // namespace tempolux
