// Aimed photons carry the same light as uniform ones: total, through any small window, from sun and sky.
#include "lib/light/aim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lib/core/random.h"
#include "tests/lib/light/light_scene.h"

namespace tempolux {
namespace {

constexpr double kPiD = std::numbers::pi;

/// Mean of `value` over n photons, and its standard error.
struct Estimate {
  double mean = 0, error = 0, most = 0;
  int hits = 0;
};
template <class Value>
Estimate estimate(int n, Value value) {
  double sum = 0, squares = 0;
  Estimate e;
  for (int i = 0; i < n; ++i) {
    const PathRandom random(7, std::uint64_t(i));
    std::array<double, 4> u;
    for (std::uint32_t k = 0; k < 4; ++k) u[k] = unit_double(random.bits(0, Purpose::test, k));
    const double x = value(u);
    sum += x;
    squares += x * x;
    e.hits += x > 0;
    e.most = std::max(e.most, x);
  }
  e.mean = sum / n;
  e.error = std::sqrt(std::max(0.0, squares / n - e.mean * e.mean) / n);
  return e;
}

/// Two spheres that overlap and one apart, with different weights, in a scene of radius 100.
const std::vector<AimSphere> kSpheres = {{{10, 0, 5}, 3, 1}, {{11, 1, 6}, 2, 5}, {{-60, 20, 0}, 0.5, 0.1}};
const Vec3 kTravel = normalize(Vec3{0.3f, -0.2f, -0.9f});

/// The mean flux is that of the uniform disc, 1. No photon has more than 1 / kUniform of it.
TEST(Aim, TheTotalIsThatOfTheUniformDisc) {
  const Aim aim(kSpheres, {}, {1, 2, 3}, 100);
  const Estimate total = estimate(1 << 18, [&](const auto& u) { return aim.start(kTravel, u[0], u[1]).flux; });
  EXPECT_NEAR(total.mean, 1, 3 * total.error);
  EXPECT_LE(total.most, 1 / Aim::kUniform);
}

/// A sphere half outside of the scene's sphere adds no light: photons that start outside the scene's disc are black.
TEST(Aim, SpheresBeyondTheSceneAddNothing) {
  const Aim aim(std::vector<AimSphere>{{{100, 0, 0}, 20, 1}}, {}, {}, 100);
  const Estimate total = estimate(1 << 18, [&](const auto& u) { return aim.start({0, 0, -1}, u[0], u[1]).flux; });
  EXPECT_NEAR(total.mean, 1, 3 * total.error);
}

/// A window of radius a that faces the light receives a^2 / R^2 of it, wherever the window is: in one sphere, in two,
/// at the rim of one, in none. Half a million photons measure it to 2 % in a sphere; uniform photons would need a
/// hundred million.
TEST(Aim, ThroughAnyWindowGoesItsShare) {
  const Vec3 centre{1, 2, 3};
  const Aim aim(kSpheres, {}, centre, 100), wide;
  EXPECT_TRUE(wide.empty());
  struct Window {
    Vec3 middle;
    float a;
    bool inside;
  };
  for (const auto& [middle, a, inside] : {Window{{11, 0.5f, 6}, 0.5f, true}, Window{{8, -2, 5}, 1, false},
                                          Window{{-60, 20, 0}, 0.4f, true}, Window{{30, 40, 0}, 20, false}}) {
    const Estimate through = estimate(1 << 19, [&](const auto& u) {
      const Aim::Start start = aim.start(kTravel, u[0], u[1]);
      const Vec3 to = middle - start.origin;
      const Vec3 off = to - kTravel * dot(to, kTravel);
      return dot(off, off) < a * a ? start.flux : 0;
    });
    const double exact = double(a) * a / 1e4;
    EXPECT_NEAR(through.mean, exact, 3 * through.error + 1e-5 * exact) << middle.x;  // floats of 100 m
    EXPECT_LT(through.error, (inside ? 0.02 : 1) * exact) << middle.x;
  }
}

/// With openings, alone and beside spheres, the total is that of the uniform disc, and a window in an opening gets its
/// share: a^2 / R^2 = 2.5e-5. density() is 1 / flux of the starts. Openings hold nothing, and no bounce is aimed at
/// them.
TEST(Aim, StartsPassOpenings) {
  const std::vector<AimSphere> openings = {{{30, 10, 5}, 1, 3}, {{31, 10, 5}, 0.5, 1}};
  const Vec3 centre{1, 2, 3}, window{30.5f, 10, 5};
  for (const std::vector<AimSphere>& spheres : {std::vector<AimSphere>{}, kSpheres}) {
    const Aim aim(spheres, openings, centre, 100);
    EXPECT_FALSE(aim.empty());
    EXPECT_EQ(aim.size(), spheres.size());
    int other = 0;  // starts at a rim, where rounding decides
    const Estimate total = estimate(1 << 18, [&](const auto& u) {
      const Aim::Start start = aim.start(kTravel, u[0], u[1]);
      other += start.flux > 0 && std::abs(start.flux * aim.density(start.origin + kTravel * 100, kTravel) - 1) > 1e-4;
      return start.flux;
    });
    EXPECT_LT(other, 64);
    EXPECT_NEAR(total.mean, 1, 3 * total.error);
    EXPECT_LE(total.most, 1 / Aim::kUniform);
    const Estimate through = estimate(1 << 18, [&](const auto& u) {
      const Aim::Start start = aim.start(kTravel, u[0], u[1]);
      const Vec3 to = window - start.origin, off = to - kTravel * dot(to, kTravel);
      return dot(off, off) < 0.25f ? start.flux : 0;
    });
    EXPECT_NEAR(through.mean, 2.5e-5, 3 * through.error);
    EXPECT_LT(through.error, 0.01 * 2.5e-5) << "uniform starts have an error of 39 %";
    EXPECT_FALSE(aim.holds({30, 10, 5}));
    EXPECT_EQ(aim.aims_from({90, 0, 0}), !spheres.empty());
  }
}

TEST(Aim, HoldsWhatLiesInASphere) {
  const Aim aim(kSpheres, {}, {1, 2, 3}, 100);
  EXPECT_TRUE(aim.holds({10, 2.9f, 5}));
  EXPECT_TRUE(aim.holds({-60, 20.4f, 0}));
  EXPECT_FALSE(aim.holds({-60, 20.6f, 0}));
}

/// A hut of 4 m with a hole of 1 m x 1 m in its roof, z = 3, in a scene of 1000 m. Sun and sky send E cos A and pi L
/// A (from the upper hemisphere) through the hole. Aimed photons have all directions of the light.
class ThroughTheRoof : public testing::Test {
 protected:
  LightScene scene_{500};
  Environment environment_;
  const double kIrradiance = 3, kRadiance = 2;

  Estimate through(bool aimed, int photons) {
    EmissionTable table = scene_.table();
    if (aimed) table.aim = {{{20, 30, 2}, 3.5, 0.75}, {{22, 30, 2}, 3.5, 0.25}};
    const Lights lights(scene_.frame, table);
    const double total = lights.total_flux().g;
    const Estimate all = estimate(photons, [&](const auto& u) { return double(lights.emit(u).flux.g); });
    EXPECT_NEAR(all.mean, total, 3 * all.error + 1e-6 * total) << "the total";
    return estimate(photons, [&](const auto& u) {
      const PhotonEmission e = lights.emit(u);
      if (!(e.travel.z < 0)) return 0.0;
      const Vec3 at = e.origin + e.travel * ((3 - e.origin.z) / e.travel.z);
      return std::abs(at.x - 20) < 0.5f && std::abs(at.y - 30) < 0.5f ? double(e.flux.g) : 0.0;
    });
  }
};

TEST_F(ThroughTheRoof, OfTheSun) {
  const Vec3 down = normalize(Vec3{0.4f, 0.1f, -0.8f});
  scene_.add(PunctualLight::Kind::directional, Rgb(float(kIrradiance)), {}, down);
  const Estimate aimed = through(true, 1 << 17), uniform = through(false, 1 << 17);
  EXPECT_NEAR(aimed.mean, kIrradiance * double(-down.z), 3 * aimed.error);
  EXPECT_LT(aimed.error, 0.03 * aimed.mean);
  EXPECT_LT(1000 * uniform.hits, aimed.hits) << "the scene's disc has 2.4 km^2";
}

TEST_F(ThroughTheRoof, OfTheSky) {
  environment_.width = 8;
  environment_.height = 4;
  environment_.radiance.assign(32, Rgb(float(kRadiance)));
  scene_.frame.environment = &environment_;
  const Estimate aimed = through(true, 1 << 17);
  EXPECT_NEAR(aimed.mean, kPiD * kRadiance, 3 * aimed.error);
  EXPECT_LT(aimed.error, 0.05 * aimed.mean);
}

/// Directions towards spheres. For one sphere the pdf is 1 / (2 pi (1 - sqrt(1 - r^2 / d^2))) everywhere in its cone.
/// For several spheres the mean of 1 / pdf is the solid angle of all cones together, here of the wider of two cones
/// about one axis.
TEST(Aim, WaysIntoSpheresHaveTheDensityOfTheirCones) {
  const Vec3 place{40, -30, 20};
  const auto solid_angle = [](double r, double d) { return 2 * kPiD * (1 - std::sqrt(1 - r * r / (d * d))); };
  const Aim one(std::vector<AimSphere>{{{10, 10, -5}, 4, 2}}, {}, {1, 2, 3}, 100);
  const double far = length(Vec3d(place) - Vec3d{10, 10, -5});
  for (int i = 0; i < 1000; ++i) {
    const Aim::Way way = one.towards(place, PathRandom(3, std::uint64_t(i)).get2(0, Purpose::test));
    EXPECT_NEAR(way.pdf_solid_angle * solid_angle(4, far), 1, 1e-6);
    EXPECT_NEAR(length(way.direction), 1, 1e-6);
    const Vec3 to = Vec3{10, 10, -5} - place;
    EXPECT_LE(length(cross(to, way.direction)), 4 * (1 + 1e-5f));
  }
  const Aim two(std::vector<AimSphere>{{{40, -30, 0}, 3, 1}, {{40, -30, -20}, 2, 4}}, {}, {1, 2, 3}, 100);
  int other = 0;  // directions at a rim, where rounding decides
  const Estimate angle = estimate(1 << 16, [&](const auto& u) {
    const Aim::Way way = two.towards(place, {float(u[0]), float(u[1])});
    other += std::abs(two.pdf_solid_angle(place, way.direction) / way.pdf_solid_angle - 1) > 1e-4;
    return 1 / way.pdf_solid_angle;
  });
  EXPECT_NEAR(angle.mean, solid_angle(3, 20), 4 * angle.error);
  EXPECT_LT(other, 64);
}

/// A small sphere, a room, inside a large one, the ground around it. From the ground bounces are aimed at the room
/// alone, with the pdf of its cone; inside the room they are not aimed, nor between rooms of about one size.
TEST(Aim, BouncesOnTheGroundAreAimedAtTheRoomInsideIt) {
  const std::vector<AimSphere> spheres{{{0, 0, 0}, 50, 3}, {{10, 0, 0}, 2, 1}, {{13, 0, 0}, 3, 1}};
  const Aim aim(spheres, {}, {}, 100);
  EXPECT_TRUE(aim.aims_from({-20, 0, 0}));
  EXPECT_TRUE(aim.aims_from({80, 0, 0}));
  EXPECT_FALSE(aim.aims_from({9, 0, 0}));
  EXPECT_FALSE(aim.aims_from({15, 0, 0}));
  const Vec3 place{10, -20, 0};
  for (int i = 0; i < 100; ++i) {
    const Aim::Way way = aim.towards(place, PathRandom(3, std::uint64_t(i)).get2(0, Purpose::test));
    const double into = aim.pdf_solid_angle(place, way.direction);
    EXPECT_NEAR(into, way.pdf_solid_angle, 1e-3 * into);
    bool meets = false;
    for (const std::size_t k : {1u, 2u})
      meets =
          meets || length(cross(Vec3(spheres[k].centre) - place, way.direction)) <= float(spheres[k].radius) * 1.00001f;
    EXPECT_TRUE(meets);
  }
  EXPECT_EQ(aim.pdf_solid_angle(place, {0, -1, 0}), 0);
}

}  // namespace
}  // namespace tempolux
