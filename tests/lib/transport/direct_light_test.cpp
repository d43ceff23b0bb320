// Light samples, emission that is met and roulette: each against an irradiance known on paper.
#include "lib/transport/direct_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/sampling.h"
#include "lib/transport/emission.h"
#include "lib/transport/media.h"
#include "lib/transport/roulette.h"
#include "tests/support/places.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::place_at;

constexpr Vec3 kUp{0, 1, 0};

/// A square lamp of radiance 2 and half-width a straight above a place, at height 1, that shines down. From its
/// quarters E = 2 x 4 x / sqrt(1 + x^2) atan(x / sqrt(1 + x^2)), x = a.
struct Lamp {
  static constexpr float kHalf = 0.5f;
  HandMadeScene scene;
  const SceneFrame& frame;
  Tracer tracer;
  Lights lights;
  explicit Lamp(HandMadeScene made = lamp())
      : scene(std::move(made)), frame(scene.frame()), tracer(frame), lights(frame, build_emission_table({&frame, 1})) {}
  static HandMadeScene lamp() {
    HandMadeScene scene;
    constexpr float a = kHalf;
    scene.add_quad({-a, 1, -a}, {a, 1, -a}, {a, 1, a}, {-a, 1, a}, matte(Rgb(0.0f), Rgb(2.0f)));
    return scene;
  }
  static double irradiance() {
    const double side = double(kHalf) / std::hypot(1.0, double(kHalf));
    return 8 * side * std::atan(side);
  }
};

/// 4096 samples of a smooth integrand, independent: each errs by less than half of the mean, all by 0.8 %; the band is
/// 3 of those.
TEST(SampleDirect, MeanIsTheIrradianceOfALamp) {
  const Lamp lamp;
  const SurfacePoint place = place_at({0, 0, 0}, kUp);
  double sum = 0;
  constexpr int kSamples = 4096;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const PathRandom random(1, i);
    DirectSample direct;
    if (!sample_direct(lamp.lights, {place, kUp, kUp}, random.get1(0, Purpose::light_choice),
                       random.get2(0, Purpose::light_point), direct))
      continue;
    sum += double(direct.irradiance.g * transmittance(lamp.tracer, direct.shadow, {random, 0, way_shadow}).g);
  }
  EXPECT_NEAR(sum / kSamples / Lamp::irradiance(), 1, 0.024);
}

/// Light from behind one of the normals does not count. A coat reduces light by the angle. A sheet in between blocks
/// it. Seen to fail: light from behind the geometric normal let in.
TEST(SampleDirect, NormalsCoatAndShadow) {
  const Lamp lamp;
  const SurfacePoint place = place_at({0, 0, 0}, kUp);
  const Vec3 aside = normalize(Vec3{1, -0.01f, 0});  // sees none of the lamp's x < 0 side
  Material material = matte(Rgb(0.5f));
  material.specular = 1;
  material.roughness = 0.3f;
  const Bsdf coat(material);
  DirectSample plain, coated;
  for (std::uint32_t i = 0; i < 64; ++i) {
    const Vec2 u = PathRandom(2, i).get2(0, Purpose::light_point);
    EXPECT_FALSE(sample_direct(lamp.lights, {place, kUp * -1.0f, kUp}, 0.5f, u, plain));
    if (sample_direct(lamp.lights, {place, kUp, aside}, 0.5f, u, plain)) { EXPECT_GT(dot(plain.light.wi, aside), 0); }
    ASSERT_TRUE(sample_direct(lamp.lights, {place, kUp, kUp}, 0.5f, u, plain));
    ASSERT_TRUE(sample_direct(lamp.lights, {place, kUp, kUp, &coat}, 0.5f, u, coated));
    EXPECT_NEAR(coated.irradiance.g / plain.irradiance.g, coat.arrival_weight(Vec3{0, 0, plain.light.wi.y}), 1e-5f);
  }
  HandMadeScene covered = Lamp::lamp();
  covered.add_quad({-2, 0.5f, -2}, {-2, 0.5f, 2}, {2, 0.5f, 2}, {2, 0.5f, -2}, matte(Rgb(0.0f)));
  const Lamp shadowed(std::move(covered));
  EXPECT_EQ(transmittance(shadowed.tracer, plain.shadow, {PathRandom(1, 1), 0, way_shadow}).g, 0);
}

/// Half of the estimate by directions drawn by the cosine, which meet the lamp, and half by light samples, each weighed
/// by the power heuristic: the sum is the irradiance. Without the weight of one of the two it would be 1.5 times as
/// much or more. 16384 directions err by about 1 %. Seen to fail: emission at hits counted in full beside light
/// samples.
TEST(WeighedEmission, JoinsLightSamplesToTheWhole) {
  const Lamp lamp;
  const SurfacePoint place = place_at({0, 0, 0}, kUp);
  double met = 0, sampled = 0;
  constexpr int kSamples = 16384;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const PathRandom random(3, i);
    const Vec3 local = sample_hemisphere_cos(random.get2(0, Purpose::scatter)), travel = Frame(kUp).to_world(local);
    const float pdf = local.z * kInvPi;
    Hit hit;
    if (lamp.tracer.intersect({place.position, travel, 0, INFINITY}, hit))
      met += double(
          weighed_emission(lamp.lights, lamp.tracer.surface_point(hit), -travel, {true, place.position, kUp, pdf}, 0)
              .g *
          kPi);
    DirectSample direct;
    if (sample_direct(lamp.lights, {place, kUp, kUp}, random.get1(0, Purpose::light_choice),
                      random.get2(0, Purpose::light_point), direct))
      sampled += double(direct.irradiance.g * mis_power(direct.light.pdf_solid_angle, direct.light.wi.y * kInvPi));
  }
  EXPECT_NEAR((met + sampled) / kSamples / Lamp::irradiance(), 1, 0.03);
  EXPECT_GT(met / kSamples, 0.01 * Lamp::irradiance());
  // Where light samples could not find the lamp, as after a mirror, all of its radiance counts.
  Hit hit;
  ASSERT_TRUE(lamp.tracer.intersect({{0, 0, 0}, kUp, 0, INFINITY}, hit));
  EXPECT_EQ(weighed_emission(lamp.lights, lamp.tracer.surface_point(hit), kUp * -1.0f, {}, 0).g, 2);
}

/// Of 4096 even numbers u the share .3 survives with weight 1: the mean stays. A weight above `most` survives with that
/// probability. Seen to fail: the weight not divided by the probability of survival.
TEST(Survives, KeepsTheMean) {
  constexpr int kTimes = 4096;
  for (const float weight : {0.3f, 5.0f}) {
    double sum = 0;
    for (int i = 0; i < kTimes; ++i) {
      Rgb left(weight, 0.5f * weight, 0);
      if (survives(left, 0.95f, (float(i) + 0.5f) / kTimes)) sum += double(left.g);
    }
    EXPECT_NEAR(sum / kTimes / (0.5 * double(weight)), 1, 2.0 / (0.3 * kTimes));
  }
}

}  // namespace
}  // namespace tempolux
