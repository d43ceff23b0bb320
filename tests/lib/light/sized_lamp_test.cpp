// Punctual lights with a size: light samples and photons against irradiances known on paper.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lib/core/pi.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "tests/lib/light/light_scene.h"

namespace tempolux {
namespace {

using Kind = PunctualLight::Kind;

constexpr Vec3 kUp{0, 0, 1};

/// Irradiance in the red channel at a point by light samples. `visible(sample)` is the share that arrives.
template <class Visible>
double irradiance_behind(const Lights& lights, Vec3 point, Vec3 normal, const Visible& visible,
                         std::uint32_t samples = 1 << 14) {
  double sum = 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    LightSample s;
    if (!lights.sample(point, normal, sobol_owen_1d(i, 3), sobol_owen_2d(i, 5), s)) continue;
    EXPECT_TRUE(is_finite(s.wi) && is_finite(s.facing_irradiance) && is_finite(s.position));
    EXPECT_TRUE(s.only_sampled) << "else a MIS weight would take light away, although no ray brings it";
    sum += double(s.facing_irradiance.r) * std::max(0.0, double(dot(normal, s.wi))) * visible(s);
  }
  return sum / samples;
}
double irradiance(const Lights& lights, Vec3 point, Vec3 normal, std::uint32_t samples = 1 << 14) {
  return irradiance_behind(
      lights, point, normal, [](const LightSample&) { return 1.0; }, samples);
}

LightScene with_lamp(Kind kind, float intensity, Vec3 position, Vec3 direction, LampSize size) {
  LightScene scene;
  scene.add(kind, Rgb(intensity), position, direction, 0.2f, 0.5f);
  scene.frame.lights.back().light.size = size;
  return scene;
}

/// Irradiance on the disc of radius `reach` around the origin in the plane z = 0, from above, by 2^18 photons.
double photon_irradiance(const Lights& lights, double reach) {
  constexpr std::uint32_t kPhotons = 1 << 18;
  double flux = 0;
  for (std::uint32_t i = 0; i < kPhotons; ++i) {
    const Vec2 a = sobol_owen_2d(i, 7), b = sobol_owen_2d(i, 11);
    const PhotonEmission e = lights.emit({double(a.x), double(a.y), double(b.x), double(b.y)});
    const double t = -double(e.origin.z) / double(e.travel.z);
    if (!(t > 0 && e.origin.z > 0)) continue;
    if (std::hypot(double(e.origin.x) + t * double(e.travel.x), double(e.origin.y) + t * double(e.travel.y)) < reach)
      flux += double(e.flux.r);
  }
  return flux / kPhotons / (kPiD * reach * reach);
}

/// The mean of the irradiance by light samples over the same disc.
double mean_irradiance(const Lights& lights, double reach) {
  constexpr std::uint32_t kPlaces = 256;
  double sum = 0;
  for (std::uint32_t i = 0; i < kPlaces; ++i) {
    const Vec2 at = sample_disc_concentric(sobol_owen_2d(i, 13));
    sum += irradiance(lights, Vec3{at.x * float(reach), at.y * float(reach), 0}, kUp, 256);
  }
  return sum / kPlaces;
}

/// A surface that faces a sphere of radiance I / (pi r^2) receives pi L sin^2 = I / d^2 outside of it, and pi L =
/// I / r^2 inside. The smallest sphere has an r^2 / d^2 of 1e-12, below what floats tell from 0 beside 1. Seen to fail:
/// 1 - cos by a subtraction in float; the density of all directions outside.
TEST(SizedLamp, FacingSurfaceReceivesWhatAPointGives) {
  for (const float share : {1e-6f, 1e-4f, 0.01f, 0.1f, 0.5f, 0.9f, 0.999f}) {
    const LightScene scene = with_lamp(Kind::point, 3, {0.5f, 0, 2}, kUp, {.radius_m = 2 * share});
    EXPECT_NEAR(irradiance(scene.lights(), {0.5f, 0, 0}, kUp) / 0.75, 1, 0.003) << share;
  }
  const LightScene around = with_lamp(Kind::point, 3, {0.5f, 0, 0.4f}, kUp, {.radius_m = 2});
  for (const float height : {0.0f, 0.4f, 1.0f})
    EXPECT_NEAR(irradiance(around.lights(), {0.5f, 0, height}, kUp) / 0.75, 1, 0.003) << height;
}

/// Samples lie on the sphere, on its nearer side for a place outside and ahead for a place inside; the light tree's box
/// holds them. Seen to fail: the far side taken outside, where the lamp's own fittings would shade it.
TEST(SizedLamp, SamplesLieOnTheSphere) {
  const Vec3 centre{0.2f, -0.3f, 1};
  const LightScene scene = with_lamp(Kind::point, 1, centre, kUp, {.radius_m = 0.5f});
  const Lights lights = scene.lights();
  const LightBounds bounds = PunctualSource{scene.frame.lights[0], lights.aim()}.bounds();
  for (const Vec3 place : {Vec3{0, 0, 0}, Vec3{3, 1, 2}, Vec3{0.3f, -0.3f, 1.2f}})
    for (std::uint32_t i = 0; i < 256; ++i) {
      LightSample s;
      ASSERT_TRUE(lights.sample(place, {}, 0, sobol_owen_2d(i, 1), s));
      const Vec3 out = (s.position - centre) / 0.5f;
      EXPECT_NEAR(length(out), 1, 1e-5);
      EXPECT_NEAR(length(normalize(s.position - place) - s.wi), 0, 1e-5);
      const bool outside = length(place - centre) > 0.5f;
      EXPECT_TRUE(outside ? dot(out, s.wi) < 1e-3f : dot(out, s.wi) > 0);
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_TRUE(s.position[axis] > bounds.box.lower[axis] - 1e-5f &&
                    s.position[axis] < bounds.box.upper[axis] + 1e-5f);
    }
}

/// A lamp whose middle is below the horizon, but not all of it, beside a brighter lamp below: its light is found. Half
/// of a sphere of directions is integrated on a fine grid. Seen to fail: the light tree's box without the radius, which
/// culls the lamp; the weight of a sun by its middle.
TEST(SizedLamp, LightAboveTheHorizonOfALampBelowIt) {
  LightScene scene = with_lamp(Kind::point, 1, {1, 0, -0.1f}, kUp, {.radius_m = 0.5f});
  scene.add(Kind::point, Rgb(50.0f), {0, 0, -2}, kUp);
  double wanted = 0;
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i)  // cosines to the normal
    for (int j = 0; j < kSteps; ++j) {
      const double z = (i + 0.5) / kSteps, phi = 2 * kPiD * (j + 0.5) / kSteps, across = std::sqrt(1 - z * z);
      const Vec3d way{across * std::cos(phi), across * std::sin(phi), z}, to{1, 0, -0.1};
      if (dot(way, to) > 0 && length2(cross(way, to)) < 0.25) wanted += z / (kPiD * 0.25);
    }
  wanted *= 2 * kPiD / kSteps / kSteps;
  EXPECT_NEAR(irradiance(scene.lights(), {0, 0, 0}, kUp) / wanted, 1, 0.01);

  // A sun of the angular diameter 1, whose middle lies .2 below the horizon: by a sum over chords parallel to it.
  const float down = 0.2f;
  const LightScene dusk =
      with_lamp(Kind::directional, 2, {}, Vec3{-std::cos(down), 0, std::sin(down)}, {.angle_rad = 1});
  double sun = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double height = 0.3 * (i + 0.5) / kSteps;  // above the horizon; the disc reaches to .5 - .2
    // cos of half the angle of longitude for which a direction at this height lies in the disc
    const double cosine = (std::cos(0.5) + std::sin(height) * std::sin(0.2)) / (std::cos(height) * std::cos(0.2));
    sun += std::sin(height) * std::cos(height) * 2 * std::acos(std::min(1.0, cosine)) * 0.3 / kSteps;
  }
  sun *= 2 / (kPiD * std::pow(std::sin(0.5), 2));
  EXPECT_NEAR(irradiance(dusk.lights(), {0, 0, 0}, kUp) / sun, 1, 0.01);
}

/// Far away a spot with a size is the spot without: the cone widens by r / d at most. The flux is that of the spot.
/// Seen to fail: the falloff by the direction to the sphere's middle times a radiance by the sphere's area 4 pi r^2.
TEST(SizedLamp, SpotFarAwayIsThatWithoutSize) {
  const LightScene sized = with_lamp(Kind::spot, 10, {0, 0, 4}, -kUp, {.radius_m = 0.02f}),
                   sharp = with_lamp(Kind::spot, 10, {0, 0, 4}, -kUp, {});
  for (const float angle : {0.0f, 0.15f, 0.3f, 0.4f, 0.45f}) {
    const Vec3 place{4 * std::tan(angle), 0, 0};
    EXPECT_NEAR(irradiance(sized.lights(), place, kUp), irradiance(sharp.lights(), place, kUp), 0.005) << angle;
  }
  EXPECT_EQ(sized.lights().total_flux(), sharp.lights().total_flux());
}

/// A sun keeps its irradiance at every size, E cos t where all of it is above the horizon. Its disc has the radiance
/// E / (pi sin^2 a), so through the scene sphere's disc comes 2 / (1 + cos a) E pi R^2. Seen to fail: E over the solid
/// angle as the radiance, which gives (1 + cos a) / 2 of the irradiance.
TEST(SizedLamp, SunKeepsItsIrradiance) {
  for (const float angle : {0.0f, 0.0093f, 0.5f, 1.5f}) {
    const LightScene scene = with_lamp(Kind::directional, 3, {}, normalize(Vec3{0.3f, 0.2f, -1}), {.angle_rad = angle});
    EXPECT_NEAR(irradiance(scene.lights(), {0, 0, 0}, kUp) / (3 / std::sqrt(1.13)), 1, 0.001) << angle;
    const double r2 = std::pow(scene.lights().aim().scene_radius(), 2);
    EXPECT_NEAR(scene.lights().total_flux().r / (3 * kPiD * r2 * 2 / (1 + std::cos(double(angle) / 2))), 1, 1e-6);
  }
}

/// The penumbra of a half plane x < 0 at height h under a sun in the zenith. From x, the part of the sun's disc beyond
/// the edge is a segment of a circle: with t = x / (h tan a), its share is 1/2 + (t sqrt(1 - t^2) + asin t) / pi. So
/// the penumbra is h times the angle wide. For a = .01 the disc is flat within 1e-4. Seen to fail: the angle taken as
/// half the angle; the disc drawn with radii uniform in [0, 1), which is brighter in the middle.
TEST(SizedLamp, PenumbraOfAHalfPlane) {
  const double a = 0.01, height = 2;
  const LightScene scene = with_lamp(Kind::directional, 1, {}, -kUp, {.angle_rad = float(2 * a)});
  for (const double t : {-1.05, -0.95, -0.5, 0.0, 0.3, 0.8, 0.95, 1.05}) {
    const double x = t * height * std::tan(a), inside = std::clamp(t, -1.0, 1.0),
                 wanted = 0.5 + (inside * std::sqrt(1 - inside * inside) + std::asin(inside)) / kPiD;
    const double lit = irradiance_behind(scene.lights(), {float(x), 0, 0}, kUp, [&](const LightSample& s) {
      return x + height * double(s.wi.x) / double(s.wi.z) > 0 ? 1.0 : 0.0;
    });
    EXPECT_NEAR(lit, wanted, 0.003) << t;
  }
}

/// The same under a sphere: from a place below, a sphere behind a half plane that ends in its middle gives half. An
/// edge that passes its outline by 5 % on either side gives all or nothing.
TEST(SizedLamp, PenumbraOfASphere) {
  const LightScene scene = with_lamp(Kind::point, 1, {0, 0, 4}, kUp, {.radius_m = 0.2f});
  const double edge = 0.2 / std::sqrt(16 - 0.04);  // tangent of the outline's angle
  for (const double t : {-1.05, 0.0, 1.05}) {
    const double lit = irradiance_behind(scene.lights(), {0, 0, 0}, kUp, [&](const LightSample& s) {
      return double(s.position.x) > t * edge * double(s.position.z) ? 1.0 : 0.0;
    });
    EXPECT_NEAR(lit * 16, t < -1 ? 1 : t > 1 ? 0 : 0.5, 0.003) << t;
  }
}

/// Photons bring the same light to a floor as light samples, for each kind and size, and their sum is the light's flux.
/// 2^18 photons of which a share of s lands err by about 1 / sqrt(2^18 s) and less by stratification. Seen to fail:
/// photons that start uniformly on the sphere and leave it uniformly; the sun's flux without 2 / (1 + cos a).
TEST(SizedLamp, PhotonsBringTheLightOfSamples) {
  const Vec3 aslant = normalize(Vec3{0.3f, 0.1f, -1});
  for (const Kind kind : {Kind::point, Kind::spot, Kind::directional})
    for (const float size : {0.0f, 0.5f, 0.9f}) {
      const LampSize of = kind == Kind::directional ? LampSize{.angle_rad = 2 * size} : LampSize{.radius_m = size};
      const LightScene scene = with_lamp(kind, 2, {0.2f, 0, 1}, aslant, of);
      const Lights lights = scene.lights();
      const double reach = 0.7, sampled = mean_irradiance(lights, reach);
      EXPECT_NEAR(photon_irradiance(lights, reach) / sampled, 1, 0.01) << int(kind) << ' ' << size;
    }
}

/// Photons leave the sphere with the cosine: the mean of the cosine to the normal is 2/3, and the places on the sphere
/// of a point lamp are uniform, so their mean is its middle. Seen to fail: starts on a disc through the middle.
TEST(SizedLamp, PhotonsLeaveTheSphereByTheCosine) {
  const Vec3 centre{1, 2, 0.5f};
  const LightScene scene = with_lamp(Kind::point, 1, centre, kUp, {.radius_m = 0.3f});
  const Lights lights = scene.lights();
  Vec3d places{};
  double cosines = 0, flux = 0;
  constexpr std::uint32_t kPhotons = 1 << 14;
  for (std::uint32_t i = 0; i < kPhotons; ++i) {
    const Vec2 a = sobol_owen_2d(i, 7), b = sobol_owen_2d(i, 11);
    const PhotonEmission e = lights.emit({double(a.x), double(a.y), double(b.x), double(b.y)});
    const Vec3d out = (Vec3d(e.origin) - Vec3d(centre)) / double(0.3f);
    EXPECT_NEAR(length(out), 1, 1e-5);
    places = places + out;
    cosines += dot(out, Vec3d(e.travel));
    flux += double(e.flux.g);
  }
  EXPECT_NEAR(length(places) / kPhotons, 0, 0.01);
  EXPECT_NEAR(cosines / kPhotons, 2.0 / 3, 0.002);
  EXPECT_NEAR(flux / kPhotons, 4 * kPiD, 1e-4);
}

}  // namespace
}  // namespace tempolux
