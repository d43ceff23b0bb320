// Light that starts, is stored and is gathered in a solid that absorbs, against Beer's law.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/gather/final_gather.h"
#include "lib/points/irradiance_points.h"
#include "lib/photon/photon_trace.h"
#include "lib/trace/solid_around.h"
#include "tests/support/materials.h"
#include "tests/support/photons.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;

constexpr float kDeep = 0.5f, kKept = 0.2f;  ///< the lamp's height above the floor; the transmittance of a metre

/// A basin whose floor lies below a lamp of 1 W/sr in water. The water is a closed box, or a sheet above the floor.
struct Basin {
  HandMadeScene scene;
  std::uint32_t floor;
  explicit Basin(bool closed) {
    Material water = test::glass(0);
    water.attenuation_color = Rgb(kKept);
    water.attenuation_distance = 1;
    if (closed) scene.add_box({-20, -1, -20}, {20, 0.3f, 20}, water);
    else scene.add_quad({-20, 0.3f, 20}, {20, 0.3f, 20}, {20, 0.3f, -20}, {-20, 0.3f, -20}, water);
    floor = scene.add_quad({-9, -kDeep, 9}, {9, -kDeep, 9}, {9, -kDeep, -9}, {-9, -kDeep, -9}, matte(Rgb(0.0f)));
    scene.add_point_light({0, 0, 0}, Rgb(1.0f));
  }
};

/// Flux of direct light on the floor: the integral of 2 pi kKept^(kDeep / mu) dmu. Photons by which it is measured are
/// 100000: .4 %. Light that leaves the lamp unabsorbed would bring 2.3 times as much.
TEST(AbsorbingSolid, PhotonsOfALampInsideAreAbsorbed) {
  double expected = 0;
  constexpr int kSteps = 10000;
  for (int i = 0; i < kSteps; ++i)
    expected += 2 * M_PI / kSteps * std::pow(double(kKept), double(kDeep) * kSteps / (i + 0.5));
  for (const bool closed : {true, false}) {
    Basin basin(closed);
    const SceneFrame& frame = basin.scene.frame();
    const Tracer tracer(frame);
    const Lights lights(frame, build_emission_table({&frame, 1}));
    PhotonOptions options;
    options.photon_count = 200000;
    double direct = 0;
    for (const formats::Photon& photon : test::photons_of(PhotonTracer(tracer, lights, options)))
      if (photon.object == basin.floor && photon.kind == formats::PathKind::direct) direct += double(photon.flux[1]);
    EXPECT_NEAR(direct / expected, 1, 0.02) << closed;
  }
}

/// Direct light at a point: I cos / d^2 kKept^d.
TEST(AbsorbingSolid, DirectLightAtPointsIsAbsorbed) {
  Basin basin(false);
  const SceneFrame& frame = basin.scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  std::vector<IrradiancePoint> points(2);
  points[0].position = {0, -kDeep, 0};
  points[1].position = {1, -kDeep, 0};
  for (IrradiancePoint& point : points) point.normal = {0, 1, 0}, point.object = basin.floor;
  const std::vector<formats::Photon> none;
  estimate_points(tracer, lights, PhotonView(none), {}, {}, points);
  for (const IrradiancePoint& point : points) {
    const double d = double(length(point.position)), beer = std::pow(double(kKept), d);
    EXPECT_NEAR(double(point.direct.g) / (double(kDeep) / (d * d * d) * beer), 1, 1e-3) << d;
  }
}

/// A small square shines down onto the floor, a metre below it: gathered light is kKept of what it is without water.
TEST(AbsorbingSolid, GatherRaysAreAbsorbed) {
  double gathered[2];
  for (const bool water : {false, true}) {
    HandMadeScene scene;
    Material material = test::glass(0);
    material.attenuation_color = Rgb(water ? kKept : 1.0f);
    material.attenuation_distance = 1;
    scene.add_quad({-20, 2, 20}, {20, 2, 20}, {20, 2, -20}, {-20, 2, -20}, material);
    scene.add_quad({-.1f, 1, -.1f}, {.1f, 1, -.1f}, {.1f, 1, .1f}, {-.1f, 1, .1f}, matte(Rgb(1.0f)));
    IrradiancePoint point;
    point.position = {0, 1, 0};
    point.normal = {0, -1, 0};
    point.indirect = Rgb(kPi);
    const Tracer tracer(scene.frame());
    const Lights lights(scene.frame(), EmissionTable{});
    const PointLookup lookup({&point, 1}, 1);
    GatherOptions options;
    options.rays = 4000;
    SurfacePoint from{};
    from.normal = from.normal_geometric = {0, 1, 0};
    from.offset = 1e-6f;
    GatherCounts counts;
    gathered[water] = double(FinalGather(tracer, lights, lookup, options).gather(from, {0, 1, 0}, counts).irradiance.g);
  }
  EXPECT_GT(gathered[0], 0);
  EXPECT_NEAR(gathered[1] / gathered[0], double(kKept), 0.02 * double(kKept));
}

/// Outside of the water, beside it and below its floor no place is in it.
TEST(AbsorbingSolid, PlacesOutsideAreOutside) {
  Basin basin(true);
  const Tracer tracer(basin.scene.frame());
  const SolidAround around(tracer);
  EXPECT_TRUE(around.any());
  EXPECT_NE(around({0, 0, 0}, {}, 0), kNone);
  EXPECT_NE(around({0, -kDeep, 0}, {0, 1, 0}, 1e-4f), kNone);
  EXPECT_EQ(around({0, 1, 0}, {}, 0), kNone);
  EXPECT_EQ(around({0, 30, 0}, {0, 1, 0}, 0), kNone);
  EXPECT_EQ(around({25, 0, 0}, {}, 0), kNone);
}

}  // namespace
}  // namespace tempolux
