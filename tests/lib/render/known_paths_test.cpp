// Camera paths that end where light is known: no light is lost and none counts twice, for any combination of known
// light.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lib/core/sobol.h"
#include "lib/gather/bright_points.h"
#include "lib/points/irradiance_points.h"
#include "lib/points/lamp_light.h"
#include "lib/material/dielectric.h"
#include "lib/render/known_light.h"
#include "lib/render/path_tracer.h"
#include "tests/support/chain.h"
#include "tests/support/closed_box.h"
#include "tests/support/frames.h"
#include "tests/support/lamp_ceiling.h"
#include "tests/support/layers.h"
#include "tests/support/materials.h"
#include "tests/support/mean.h"
#include "tests/support/places.h"

namespace tempolux {
namespace {

using test::Chain;
using test::HandMadeScene;
using test::matte;
using test::Mean;
using test::Shape;
using test::total;

/// Camera paths from just above uniform places on all surfaces, straight down.
template <class Take>
RayCounts look_everywhere(const Chain& chain, const KnownLight& known, std::uint32_t count, const Take& take) {
  const test::AreaSampler area(chain.frame);
  RayCounts counts;
  for (std::uint32_t i = 0; i < count; ++i) {
    Vec3 p, n;
    area.sample((float(i) + 0.5f) / float(count), sobol_owen_2d(i, 5), p, n);
    const Ray ray{p + n * 0.01f, -n, 0, INFINITY};
    take(trace_eye_path({chain.tracer, chain.lights}, ray, PixelRandom(3, i, 0), &known, counts));
  }
  return counts;
}

class GatherInPixels : public testing::TestWithParam<std::tuple<Shape, float>> {};

/// Points without records: each sample sends one gather ray and reads its hit. The mean indirect irradiance of a closed
/// box is F rho / (S (1 - rho)), pi / rho times the radiance of layer indirect. Tolerance: 4 sigma of the samples, 4
/// sqrt(rho / N) for the series of N photons, and 0.5 % for the points with 4 shadow rays at 5000 of them and their
/// neighbourhoods.
TEST_P(GatherInPixels, MeanIrradianceIsTheGeometricSeries) {
  const auto [shape, rho] = GetParam();
  constexpr std::uint64_t kPhotons = 100000;
  test::ClosedBox box(shape, rho);
  const Chain chain(box.scene, kPhotons, 5000, 4);
  KnownLight known;
  known.points = &chain.lookup;
  Mean irradiance;
  const RayCounts counts = look_everywhere(chain, known, 60000, [&](const Layers& seen) {
    irradiance.add(M_PI / double(rho) * double(seen[Layer::indirect].g));
    EXPECT_EQ(seen[Layer::caustic].g, 0);
  });
  const double exact = double(box.flux.g) * double(rho) / (test::AreaSampler(chain.frame).area() * (1 - double(rho)));
  const double relative = irradiance.sigma() / exact;
  EXPECT_NEAR(irradiance.mean() / exact, 1, 4 * relative + 4 * std::sqrt(double(rho) / kPhotons) + 0.005);
  EXPECT_LT(relative, 0.01);
  EXPECT_EQ(counts.lookups, 0u);
  EXPECT_EQ(counts.gathered, 60000u);
  EXPECT_GT(counts.points_read, 45000u) << "paths must end at points";
}

INSTANTIATE_TEST_SUITE_P(Rooms, GatherInPixels,
                         testing::Combine(testing::Values(Shape::cube, Shape::corridor, Shape::sphere),
                                          testing::Values(0.5f, 0.8f)));

/// Every wall emits 1 and reflects one half: 2 everywhere. Gather rays meet lights that shadow rays sample, too:
/// without MIS weights the result would be 2.5. Points estimate light of close walls with 16 shadow rays (see
/// FurnaceCache).
TEST(GatherInPixels, AFurnaceIsUniform) {
  HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f), Rgb(1.0f)));
  const Chain chain(scene, 400000, 3000, 4, 16);
  KnownLight known;
  known.points = &chain.lookup;
  Mean radiance;
  look_everywhere(chain, known, 60000, [&](const Layers& seen) { radiance.add(total(seen)); });
  EXPECT_NEAR(radiance.mean(), 2, 4 * radiance.sigma() + 0.005);
  EXPECT_LT(radiance.sigma(), 0.003);
}

/// Glossy reflections read points, too, where their rays spread wider than the points' blur. A white metal plate in the
/// furnace (2 everywhere) reflects all light, so it shows 2, rough or smooth. Most of 2000 rays from a rough plate end
/// at the wall that they meet: 0.02 m to 2 m away, a few radii of 0.1 m. A mirror shows the wall's own shadows and
/// folds: there a gather ray continues, at least one more for each.
TEST(Gloss, ReadsPointsAndMirrorsDoNot) {
  for (const float roughness : {1.0f, 0.0f}) {
    HandMadeScene made;
    made.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f), Rgb(1.0f)));
    Material metal = matte(Rgb(1.0f));
    metal.metallic = 1;
    metal.roughness = roughness;
    made.add_quad({-0.1f, 0, 0.1f}, {0.1f, 0, 0.1f}, {0.1f, 0, -0.1f}, {-0.1f, 0, -0.1f}, metal);
    const Chain chain(made, 400000, 3000, 4, 16);
    KnownLight known;
    known.points = &chain.lookup;
    RayCounts counts;
    Mean radiance;
    constexpr std::uint32_t kCount = 2000;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const Ray ray{{0.01f, 0.5f, 0.02f}, normalize(Vec3{0.02f, -1, 0.01f}), 0, INFINITY};
      const Layers seen = trace_eye_path({chain.tracer, chain.lights}, ray, PixelRandom(3, 0, i), &known, counts);
      EXPECT_EQ(total(seen), double(seen[Layer::specular].g));
      radiance.add(total(seen));
    }
    // The light of the walls themselves is 1 by rays and shadow rays; the reflected light is 1, by points with an error
    // of 1 % (AFurnaceIsUniform).
    EXPECT_NEAR(radiance.mean(), 2, 4 * radiance.sigma() + 0.01) << roughness;
    if (roughness > 0) {
      EXPECT_LT(counts.bounce, kCount * 3 / 2);
      EXPECT_GT(counts.points_read, kCount * 3 / 4);
    } else {
      EXPECT_GE(counts.bounce, 2 * kCount);
    }
  }
}

/// Where light is known, a path forks at a smooth pane. Behind the pane is a screen of radiance 1, behind the camera
/// one of 3, and neither reflects: each single path sees (1 - F) 1 + F 3, at normal incidence 1.08 for index 1.5.
/// (A path that draws one way sees 1 or 3.)
TEST(Glass, IsFollowedBothWays) {
  HandMadeScene made;
  const auto add_screen = [&](float z, const Material& material) {
    made.add_quad({-40, -40, z}, {40, -40, z}, {40, 40, z}, {-40, 40, z}, material);
  };
  add_screen(-3, matte(Rgb(0.0f), Rgb(1.0f)));
  add_screen(0, test::glass(0, true));
  made.add_quad({-40, 40, 3}, {40, 40, 3}, {40, -40, 3}, {-40, -40, 3}, matte(Rgb(0.0f), Rgb(3.0f)));
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  const RecordStore none;
  KnownLight known;
  known.records = &none;
  RayCounts counts;
  float cos_t;
  EXPECT_NEAR(fresnel_dielectric(1, 1 / 1.5f, cos_t), 0.04f, 1e-6f);
  for (const float slant : {0.0f, 1.0f}) {
    const Ray ray{{0, 0, 1}, normalize(Vec3{slant, 0, -1}), 0, INFINITY};
    const double reflected = double(fresnel_dielectric(-ray.direction.z, 1 / 1.5f, cos_t));
    for (std::uint32_t i = 0; i < 100; ++i)
      EXPECT_NEAR(total(trace_eye_path({tracer, lights}, ray, PixelRandom(3, 0, i), &known, counts)), 1 + 2 * reflected,
                  1e-5);
  }
}

/// A cache without a valid record changes nothing: without points the gather ray continues as a path, and every layer
/// equals that of the path tracer to the bit.
TEST(MissingRecords, LeaveThePathAsItIs) {
  const test::Cornell c;
  const RecordStore none;
  KnownLight known;
  known.records = &none;
  RayCounts path_counts, counts;
  for (std::uint64_t pixel = 0; pixel < 64 * 36; ++pixel) {
    const Ray ray = c.view.middle(int(pixel % 64), int(pixel / 64));
    const Layers path = trace_eye_path(c.render_scene(), ray, PixelRandom(1, pixel, 0), nullptr, path_counts);
    const Layers here = trace_eye_path(c.render_scene(), ray, PixelRandom(1, pixel, 0), &known, counts);
    for (std::size_t l = 0; l < kLayerCount; ++l)
      ASSERT_EQ(here.value[l], path.value[l]) << pixel << ' ' << kLayerNames[l];
  }
  EXPECT_EQ(counts.bounce, path_counts.bounce);
  EXPECT_GT(counts.gathered, 64u * 36 / 2);
  EXPECT_LE(counts.gathered, 64u * 36);
}

/// One record of irradiance 7 lies on the floor, none on the ceiling. On the floor it gives the light, and the path
/// ends at the first hit of its next ray. On the ceiling this ray ends at points.
TEST(MissingRecords, TakeOneRayEach) {
  test::ClosedBox box(Shape::cube, 0.5f);
  const Chain chain(box.scene, 20000, 5000, 4);
  IrradianceRecord record;
  record.position = {-0.5f, -1, 0};
  record.normal = {0, 1, 0};
  record.irradiance = Rgb(7.0f);
  record.radius = record.radius_unclamped = 0.4f;
  RecordStore store;
  ASSERT_TRUE(store.add(record));
  KnownLight known;
  known.points = &chain.lookup;
  known.records = &store;
  RayCounts floor, ceiling;
  const RenderScene scene{chain.tracer, chain.lights};
  const auto look = [&](float y, std::uint32_t i, RayCounts& counts) {
    return trace_eye_path(scene, {{-0.5f, 0, 0}, {0, y, 0}, 0, INFINITY}, PixelRandom(3, 0, i), &known,
                          counts)[Layer::indirect]
        .g;
  };
  constexpr std::uint32_t kCount = 1000;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    EXPECT_NEAR(look(-1, i, floor), 7 * 0.5f * kInvPi, 1e-5f);
    EXPECT_GT(look(1, i, ceiling), 0);
  }
  EXPECT_EQ(floor.lookups, kCount);
  EXPECT_EQ(floor.gathered, 0u);
  EXPECT_EQ(floor.bounce, kCount) << "one ray, to be joined with light sampling";
  EXPECT_EQ(ceiling.lookups, 0u);
  EXPECT_EQ(ceiling.gathered, kCount);
  EXPECT_GT(ceiling.points_read, kCount * 3 / 4);
  EXPECT_LT(ceiling.bounce, kCount * 3 / 2) << "most end at the first";
}

/// A lamp 3 mm below a ceiling lights a floor by its spot. A plate of 20 cm, 10 cm above the floor, hides the ceiling
/// within 1 m of the spot from the place below the plate's middle. A record half a metre away is read there, too.
/// Pixels that sample the spot show the plate's shadow, in which 1 % of the light is left: that of the ceiling farther
/// from the lamp, which records hold. At the record they show the light of the whole ceiling. Seen to fail: a record
/// with the spot's light (1.1 of the light of the place without the plate, twice the light at the record), pixels that
/// do not sample the spot (.01 at the record).
TEST(LampSpots, ShadeIndirectLightBetweenRecords) {
  test::Ceiling ceiling(0.003);
  ceiling.scene.add_quad({-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}, matte(Rgb(0.5f)));
  ceiling.scene.add_quad({-0.1f, 0.1f, 0.1f}, {0.1f, 0.1f, 0.1f}, {0.1f, 0.1f, -0.1f}, {-0.1f, 0.1f, -0.1f},
                         matte(Rgb(0.0f)));
  const SceneFrame& frame = ceiling.scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  PointLookup lookup(ceiling.points, test::Ceiling::kSpacing, point_clearance(tracer));
  const BrightPoints divided(tracer, lights, lookup, {}, {.beside_lamps = note_lamps_beside(tracer, lights, lookup)});
  const FinalGather gather(tracer, lights, lookup, {.rays = 2000, .bright = &divided, .lamps_apart = true});
  GatherCounts counts;
  RecordStore store;
  IrradianceRecord record = gather.gather(test::place_at({0.5f, 0, 0}, {0, 1, 0}), {0, 1, 0}, counts);
  record.radius = 1;
  ASSERT_TRUE(store.add(record));
  // The pixels' spots know the points' spacing alone, as those of a file with `lamps-apart` do.
  const PointLookup no_points({}, test::Ceiling::kSpacing);
  const BrightPoints spots(tracer, lights, no_points, {},
                           {.beside_lamps = photons_beside_lamps(tracer, lights, no_points)});
  KnownLight known;
  known.records = &store;
  known.lamp_spots = &spots;
  known.lights_are_met = false;
  const auto irradiance = [&](float x) {
    RayCounts rays;
    Mean mean;
    for (std::uint32_t i = 0; i < 16384; ++i)
      mean.add(M_PI / 0.5 *
               double(trace_eye_path({tracer, lights}, {{x, 0.05f, 0}, {0, -1, 0}, 0, INFINITY}, PixelRandom(3, 0, i),
                                     &known, rays)[Layer::indirect]
                          .g));
    return mean.mean();
  };
  const double open = ceiling.exact(0);
  const auto beside_plate = [](double x, double z) { return std::max(std::abs(x), std::abs(z)) > 1; };
  EXPECT_NEAR(irradiance(0) / open, ceiling.exact(0, beside_plate) / open, 0.02);
  EXPECT_NEAR(irradiance(0.5f) / ceiling.exact(0.5), 1, 0.02);
}

/// A lamp 3 cm below a glossy ceiling, seen by way of a small glossy floor, whose records hold no light. Layers caustic
/// (floor D, ceiling S) and specular (floor S) are integrals over the lamp's directions. 32768 samples leave .5 %. A
/// single sample errs by less than twice the light of a layer, whichever spots hold the light. Seen to fail: rays that
/// find the spot by chance (a sample errs by 4 to 38 times the light).
TEST(LampSpots, GlossReflectsThemWithoutChance) {
  constexpr double d = 0.03;
  for (const float roughness : {1.0f, 0.5f})
    for (const bool apart : {false, true}) {
      Material gloss = matte(Rgb(0.5f));
      gloss.specular = 1;
      gloss.roughness = roughness;
      HandMadeScene made;
      made.add_quad({-20, 1, -20}, {20, 1, -20}, {20, 1, 20}, {-20, 1, 20}, gloss);
      made.add_quad({0.29f, 0, 0.01f}, {0.31f, 0, 0.01f}, {0.31f, 0, -0.01f}, {0.29f, 0, -0.01f}, gloss);
      made.add_point_light({0, float(1 - d), 0}, Rgb(1.0f));
      const SceneFrame& frame = made.frame();
      const Tracer tracer(frame);
      const Lights lights(frame, build_emission_table({&frame, 1}));
      const PointLookup no_points({}, 0.5f);
      const BrightPoints spots(tracer, lights, no_points, {},
                               {.beside_lamps = photons_beside_lamps(tracer, lights, no_points)});
      IrradianceRecord dark;
      dark.position = {0.3f, 0, 0};
      dark.normal = {0, 1, 0};
      dark.radius = dark.radius_unclamped = 0.1f;
      RecordStore store;
      ASSERT_TRUE(store.add(dark));
      KnownLight known;
      known.records = &store;
      (apart ? known.lamp_spots : known.gloss_spots) = &spots;
      known.lights_are_met = false;
      const Bsdf bsdf(gloss);
      const Vec3 place{0.3f, 0, 0}, lamp{0, float(1 - d), 0}, up{0, 0, 1};
      const auto floor = [](Vec3 w) { return Vec3{w.x, w.z, w.y}; };
      const auto ceiling = [](Vec3 w) { return Vec3{w.x, w.z, -w.y}; };
      const Vec3 to_lamp = normalize(lamp - place);
      double caustic = 0,
             specular = double(bsdf.eval_specular(floor(to_lamp), up).g * to_lamp.y) / double(length2(lamp - place));
      constexpr int n = 400;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const double phi = (i + 0.5) / n * M_PI / 2, psi = (j + 0.5) / n * 2 * M_PI, r = d * std::tan(phi);
          const Vec3 y{float(r * std::cos(psi)), 1, float(r * std::sin(psi))}, wi = normalize(y - place);
          const Vec3 wo = ceiling(-wi), from = ceiling(normalize(lamp - y));
          const double flux = std::sin(phi) * (M_PI / 2 / n) * (2 * M_PI / n), here = double(wi.y),
                       arrives = flux * here * here / double(length2(y - place)),
                       glossy = double(bsdf.eval_specular(from, wo).g),
                       matte_too = double(bsdf.eval_diffuse(from, wo).g);
          caustic += arrives * glossy * double(bsdf.eval_diffuse(floor(wi), up).g);
          specular += arrives * (glossy + matte_too) * double(bsdf.eval_specular(floor(wi), up).g);
        }
      RayCounts rays;
      Mean found_caustic, found_specular;
      for (std::uint32_t i = 0; i < 32768; ++i) {
        const Layers seen = trace_eye_path({tracer, lights}, {{0.3f, 0.05f, 0}, {0, -1, 0}, 0, INFINITY},
                                           PixelRandom(3, 0, i), &known, rays);
        found_caustic.add(double(seen[Layer::caustic].g) / caustic);
        found_specular.add(double(seen[Layer::specular].g) / specular);
      }
      const double root = std::sqrt(32768.0);
      EXPECT_NEAR(found_caustic.mean(), 1, 0.02) << roughness << ' ' << apart;
      EXPECT_NEAR(found_specular.mean(), 1, 0.02) << roughness << ' ' << apart;
      EXPECT_LT(found_caustic.sigma() * root, 2) << roughness << ' ' << apart;
      EXPECT_LT(found_specular.sigma() * root, 2) << roughness << ' ' << apart;
    }
}

/// A plane under a uniform sky of 3, all other light known to be 0: rho L by light sampling and the continued ray, each
/// with its weight. 4096 samples of a scrambled Sobol sequence leave far less than 0.3 % (environment_render_test); one
/// of the two alone is off by tens of per cent.
TEST(MatteEnds, JoinLightSamplingUnderASky) {
  HandMadeScene made;
  made.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.5f)));
  Environment sky;
  sky.radiance = {Rgb(3.0f)};
  SceneFrame frame = made.frame();
  frame.environment = &sky;
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  const test::NoLight none(tracer);
  RayCounts counts;
  double sum = 0;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    const Ray ray{{0.1f, 1, 0.2f}, normalize(Vec3{0.2f, -1, 0.1f}), 0, INFINITY};
    const Layers seen = trace_eye_path({tracer, lights}, ray, PixelRandom(5, 1, i), &none.known, counts);
    EXPECT_EQ(total(seen), double(seen[Layer::direct].g));
    sum += total(seen) / 4096;
  }
  EXPECT_NEAR(sum, 1.5, 0.003 * 1.5);
}

/// A grey room 4 m wide with a lamp under its ceiling that shines down. A sheet of polished metal in the room throws
/// light on the floor and shows the room. The camera sees all five layers.
struct RoomWithMirror {
  HandMadeScene made;
  RoomWithMirror() {
    const Material grey = matte(Rgb(0.6f));
    made.add_room({-2, 0, -2}, {2, 3, 2}, grey);
    made.add_quad({-0.5f, 2.9f, -0.5f}, {0.5f, 2.9f, -0.5f}, {0.5f, 2.9f, 0.5f}, {-0.5f, 2.9f, 0.5f},
                  matte(Rgb(0.0f), Rgb(5.0f)));
    Material metal = matte(Rgb(0.9f));
    metal.metallic = 1;
    metal.roughness = 0.3f;
    made.add_quad({-0.9f, 0.3f, -1.3f}, {0.9f, 0.3f, -1.3f}, {0.9f, 1.5f, -1.3f}, {-0.9f, 1.5f, -1.3f}, metal);
  }
  static CameraView view(int width, int height) {
    PlacedCamera camera;
    camera.camera.kind = Camera::Kind::perspective;
    camera.camera.yfov_rad = 1.5;
    camera.scene_from_camera.translation = {0, 1.4, 1.9};
    return CameraView(camera, {}, width, height);
  }
};

std::array<double, kLayerCount> means(const RenderScene& scene, const CameraView& view, const KnownLight* known,
                                      int samples) {
  FrameOptions options;
  options.samples = samples;
  options.known = known;
  std::array<double, kLayerCount> sum{};
  for (const Layers& pixel : render_frame(scene, view, options).mean.pixels)
    for (std::size_t l = 0; l < kLayerCount; ++l) sum[l] += double(pixel.value[l].g) / (64 * 36);
  return sum;
}

/// Layer by layer against path tracing: points alone, and records and points, each without a photon map, when paths
/// find the caustic light, and with one. Light that is lost or counted twice would be a whole kind of light.
///
/// Emission, direct light and caustic light without photons come from the path tracer's own samples: equal except for
/// the order of sums. Otherwise the noise of the path tracer's 2304 x 256 samples is 0.1 % of indirect, 1.5 % of
/// specular and 2.5 % of caustic light (between seeds). Points and photons of one seed have an error of 1 %, records
/// that are valid for four pixels around, 0.2 m here, 2 %.
TEST(KnownPaths, NoLightIsCountedTwiceOrLost) {
  RoomWithMirror room;
  Chain chain(room.made, 400000, 8000, 500);
  const CameraView view = RoomWithMirror::view(64, 36);
  GatherCounts gathered;
  const PixelView views = [&](const Look& look) { return seen_through(chain.tracer, view, look); };
  place_records(chain.gather, {views, 64, 36}, {}, chain.store, gathered);
  PhotonLightOptions caustics;
  caustics.caustic_only = true;
  const PhotonLight photons(chain.tracer, chain.traced.photons, {}, caustics);
  const RenderScene scene{chain.tracer, chain.lights};
  constexpr int kSamples = 32;
  const std::array<double, kLayerCount> path = means(scene, view, nullptr, 256),
                                        same = means(scene, view, nullptr, kSamples);
  const auto layers = std::size_t(Layer::volume);  // the room has no media
  for (std::size_t l = 0; l < layers; ++l) ASSERT_GT(path[l], 0.002) << kLayerNames[l];
  for (const bool with_records : {false, true})
    for (const bool with_photons : {false, true}) {
      KnownLight known;
      known.points = &chain.lookup;
      if (with_records) known.records = &chain.store;
      if (with_photons) known.photons = &photons;
      const std::array<double, kLayerCount> here = means(scene, view, &known, kSamples);
      for (std::size_t l = 0; l < layers; ++l) {
        const Layer layer{std::uint8_t(l)};
        const bool equal =
            layer == Layer::emission || layer == Layer::direct || (layer == Layer::caustic && !with_photons);
        EXPECT_NEAR(here[l] / (equal ? same : path)[l], 1, equal ? 1e-6 : 0.04)
            << kLayerNames[l] << (with_records ? ", records" : "") << (with_photons ? ", photons" : "");
      }
    }
}

/// A room with a point lamp: from a place with known indirect and caustic light a ray is only useful if it can meet a
/// light. Without this ray the light is the same to the bit, and only glossy bounces remain, of which a matte room has
/// none.
TEST(KnownPaths, NoRayGoesOnWhereNoLightCanBeMet) {
  HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f)));
  scene.add_point_light({0, 0, 0}, Rgb(1.0f));
  const Chain chain(scene, 20000, 1000, 64);
  const PhotonLight photons(chain.tracer, chain.traced.photons, {}, {});
  ASSERT_TRUE(photons.has_indirect());
  KnownLight known;
  known.photons = &photons;
  std::array<std::vector<double>, 2> seen;
  std::array<RayCounts, 2> counts;
  for (const bool met : {false, true}) {
    known.lights_are_met = met;
    counts[met] =
        look_everywhere(chain, known, 1000, [&](const Layers& layers) { seen[met].push_back(total(layers)); });
  }
  EXPECT_EQ(seen[0], seen[1]);
  EXPECT_EQ(counts[0].bounce, 0u);
  EXPECT_GT(counts[1].bounce, 900u);
}

}  // namespace
}  // namespace tempolux
