// The cone of a spot: its light per angle, its solid angle and its directions, against integrals done on paper.
#include "lib/light/punctual.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/pi.h"

namespace tempolux {
namespace {

PunctualLight spot(double inner_rad, double outer_rad) {
  PunctualLight light;
  light.kind = PunctualLight::Kind::spot;
  light.intensity = Rgb(1.0f, 2.0f, 0.5f);
  light.inner_cone_rad = float(inner_rad);
  light.outer_cone_rad = float(outer_rad);
  return light;
}

/// Inner angle 0 and outer angle 90 degrees: s = cos t, so the falloff is cos^2 t and its integral over the sphere is
/// 2 pi / 3. Equal angles: a cone of constant intensity, 2 pi (1 - cos t). The angles are floats, hence 1e-6.
TEST(SpotProfile, SolidAngleOnPaper) {
  const SpotProfile wide(spot(0, kPiD / 2));
  for (const double t : {0.0, 0.3, 0.8, 1.5})
    EXPECT_NEAR(wide.falloff(1 - std::cos(t)), std::pow(std::cos(t), 2), 1e-6);
  EXPECT_NEAR(wide.solid_angle(), 2 * kPiD / 3, 1e-6);
  EXPECT_NEAR(SpotProfile(spot(0.5, 0.5)).solid_angle(), 2 * kPiD * (1 - std::cos(0.5)), 1e-6);
}

/// A cone of 1e-4 rad has pi t^2 (1 - t^2 / 12) sr. 1 - cos t by a subtraction would be 9e-9 off by rounding alone.
TEST(SpotProfile, NarrowConesKeepTheirDigits) {
  const double t = double(1e-4f);
  EXPECT_NEAR(SpotProfile(spot(t, t)).solid_angle() / (kPiD * t * t), 1, 1e-8);
}

/// The share of light within the angle t is 1 - cos^3 t for angles of 0 and 90 degrees, so the share u lies within
/// 1 - cos t = 1 - cbrt(1 - u). For equal angles the density is constant: 1 - cos t = u (1 - cos outer).
TEST(SpotProfile, DrawsInProportionToLight) {
  const SpotProfile wide(spot(0, kPiD / 2)), sharp(spot(0.5, 0.5));
  for (const double u : {0.0, 0.1, 0.5, 0.9, 0.999}) {
    EXPECT_NEAR(wide.sample_one_minus_cos(u), 1 - std::cbrt(1 - u), 1e-6);
    EXPECT_NEAR(sharp.sample_one_minus_cos(u), u * (1 - std::cos(0.5)), 1e-6);
  }
}

/// The numerical integral of the falloff up to an angle is the share of draws up to that angle: with a penumbra the
/// draws have one formula inside the inner cone and another outside. 1e5 steps integrate to 1e-5.
TEST(SpotProfile, DrawsFollowTheFalloff) {
  const SpotProfile profile(spot(0.4, 0.9));
  constexpr int kSteps = 100'000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double step = profile.outer / kSteps;
    sum += 2 * kPiD * step * profile.falloff((i + 0.5) * step);
    if (i % 20'000 == 19'999 && i + 1 < kSteps) {
      EXPECT_NEAR(profile.sample_one_minus_cos(sum / profile.solid_angle()), (i + 1) * step, 1e-5);
    }
  }
  EXPECT_NEAR(sum, profile.solid_angle(), 1e-5);
}

/// Point: 4 pi I. Spot: I times its solid angle. Directional: E times the disc.
TEST(PunctualFlux, OnPaper) {
  PunctualLight light = spot(0, kPiD / 2);
  EXPECT_NEAR(PunctualSource::flux(light, 3).g, 2 * 2 * kPiD / 3, 1e-5);
  light.kind = PunctualLight::Kind::point;
  EXPECT_NEAR(PunctualSource::flux(light, 3).r, 4 * kPiD, 1e-5);
  light.kind = PunctualLight::Kind::directional;
  EXPECT_NEAR(PunctualSource::flux(light, 3).b, 0.5 * kPiD * 9, 1e-5);
}

/// The mean direction of a spot with angles of 0 and 90 degrees: the integral of cos t times the density 3 cos^2 t / (2
/// pi) is 3/4, along the axis. That of a point light is 0. A midpoint lattice of 64 x 64 numbers integrates to 1e-3.
TEST(PunctualDirection, MeanDirection) {
  PlacedLight placed;
  placed.light = spot(0, kPiD / 2);
  placed.direction = normalize(Vec3{1, -2, 2});
  constexpr int kSide = 64;
  for (const bool is_spot : {true, false}) {
    if (!is_spot) placed.light.kind = PunctualLight::Kind::point;
    Vec3d sum{};
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j)
        sum = sum + Vec3d(sample_punctual_direction(placed, (i + 0.5) / kSide, (j + 0.5) / kSide));
    const Vec3d mean = sum * (1.0 / (kSide * kSide)), wanted = Vec3d(placed.direction) * (is_spot ? 0.75 : 0);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(mean[a], wanted[a], 1e-3);
  }
}

}  // namespace
}  // namespace tempolux
