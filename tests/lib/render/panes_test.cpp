// Panes (thin smooth glass) let light pass straight: light behind them is direct light times the share that passes, for
// camera paths, points, gather rays and photons alike. Answers on paper.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lib/points/lamp_light.h"
#include "lib/render/known_light.h"
#include "lib/render/path_tracer.h"
#include "tests/support/chain.h"
#include "tests/support/cut_room.h"
#include "tests/support/frames.h"
#include "tests/support/layers.h"
#include "tests/support/materials.h"
#include "tests/support/mean.h"
#include "tests/support/media.h"

namespace tempolux {
namespace {

using test::Chain;
using test::CutRoom;
using test::HandMadeScene;
using test::matte;
using test::Mean;
using test::total;

double fresnel(double cos_o) {
  const double index = 1.5, c = std::sqrt(1 - (1 - cos_o * cos_o) / (index * index));
  const double rs = (cos_o - index * c) / (cos_o + index * c), rp = (index * cos_o - c) / (index * cos_o + c);
  return (rs * rs + rp * rp) / 2;
}

constexpr float kShare = 0.59f, kReflectance = 0.5f;
constexpr float kTint[3] = {0.9f, 0.7f, 0.5f};

Material tinted_pane() {
  Material m = test::glass(0, true);
  m.transmission = kShare;
  m.base_color = {kTint[0], kTint[1], kTint[2]};
  m.double_sided = true;
  return m;
}

/// A floor at y = 0 below panes at y = 1 and above, with lights above them.
struct Floor {
  HandMadeScene scene;
  Environment sky;
  bool has_sky = false;
  int panes;
  explicit Floor(int count, float half) : panes(count) {
    scene.add_quad({-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}, matte(Rgb(kReflectance)));
    for (int i = 0; i < count; ++i) {
      const float y = 1 + 0.1f * float(i);
      // the panes face different ways
      if (i == 0) scene.add_quad({-half, y, half}, {half, y, half}, {half, y, -half}, {-half, y, -half}, tinted_pane());
      else scene.add_quad({-half, y, -half}, {half, y, -half}, {half, y, half}, {-half, y, half}, tinted_pane());
    }
  }
  SceneFrame frame() {
    SceneFrame made = scene.frame();
    if (has_sky) made.environment = &sky;
    return made;
  }
  /// Share of light that passes all panes.
  double passed(double cosine, int channel) const {
    return std::pow(double(kShare) * (1 - fresnel(cosine)) * double(kTint[channel]), panes);
  }
};

/// One kind of light above the panes, and the irradiance that arrives behind them at (x, 0, 0).
struct Case {
  const char* name;
  float half;  ///< m: of floor and panes
  bool exact;  ///< a light without extent: each light sample is exact
  std::function<void(Floor&)> add;
  std::function<double(const Floor&, double x, int channel)> irradiance;
};

/// Irradiance at (x, 0, 0) by a lamp of half-width a at height y = 1.6, radiance 1, on a grid.
double of_lamp(const Floor& floor, double x, int channel, double a) {
  constexpr int kGrid = 400;
  double sum = 0;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) {
      const double dx = a * (2 * (i + 0.5) / kGrid - 1) - x, dz = a * (2 * (j + 0.5) / kGrid - 1),
                   d2 = dx * dx + dz * dz + 1.6 * 1.6, c = 1.6 / std::sqrt(d2);
      sum += floor.passed(c, channel) * c * c / d2;
    }
  return sum * 4 * a * a / (kGrid * kGrid);
}

void add_lamp(Floor& floor, float a) {
  floor.scene.add_quad({-a, 1.6f, -a}, {a, 1.6f, -a}, {a, 1.6f, a}, {-a, 1.6f, a}, matte(Rgb(0.0f), Rgb(1.0f)));
}

std::vector<Case> cases() {
  return {
      {"sun", 50, true,
       [](Floor& f) {
         f.scene.add_sun(normalize(Vec3{0.8f, -1, 0}), Rgb(3.0f));
       },
       [](const Floor& f, double, int channel) {
         const double c = 1 / std::sqrt(1.64);
         return 3 * c * f.passed(c, channel);
       }},
      {"point", 50, true,
       [](Floor& f) {
         f.scene.add_point_light({0, 2, 0}, Rgb(10.0f));
       },
       [](const Floor& f, double x, int channel) {
         const double d2 = 4 + x * x, c = 2 / std::sqrt(d2);
         return 10 * c / d2 * f.passed(c, channel);
       }},
      {"small lamp", 50, false, [](Floor& f) { add_lamp(f, 0.1f); },
       [](const Floor& f, double x, int channel) { return of_lamp(f, x, channel, 0.1); }},
      {"wide lamp", 50, false, [](Floor& f) { add_lamp(f, 4); },
       [](const Floor& f, double x, int channel) { return of_lamp(f, x, channel, 4); }},
      {"sky", 2000, false,
       [](Floor& f) {
         f.sky.radiance = {Rgb(3.0f)};
         f.has_sky = true;
       },
       [](const Floor& f, double, int channel) {
         double sum = 0;
         constexpr int kSteps = 20000;
         for (int i = 0; i < kSteps; ++i) {
           const double c = (i + 0.5) / kSteps;
           sum += f.passed(c, channel) * c / kSteps;
         }
         return 3 * 2 * M_PI * sum;
       }},
  };
}

/// The layer direct of camera paths that start below the panes, with no light known and with all other light known to
/// be 0. Sun and point light are exact in each sample. Lamps and sky are found by light samples and by paths that go
/// straight through the panes: without MIS they would count twice. Two panes also send light between them (caustic).
TEST(Panes, LightBehindThemIsDirect) {
  for (const Case& c : cases())
    for (const int panes : {1, 2})
      for (const bool known : {false, true}) {
        Floor floor(panes, c.half);
        c.add(floor);
        const SceneFrame frame = floor.frame();
        const Tracer tracer(frame);
        const Lights lights(frame, build_emission_table({&frame, 1}));
        const test::NoLight none(tracer);
        RayCounts counts;
        for (const float x : {0.0f, 1.5f}) {
          Mean direct[3], caustic;
          const std::uint32_t samples = c.exact ? 16 : 8192;
          for (std::uint32_t i = 0; i < samples; ++i) {
            const Layers seen = trace_eye_path({tracer, lights}, {{x, 0.5f, 0}, {0, -1, 0}, 0, INFINITY},
                                               PixelRandom(5, 1, i), known ? &none.known : nullptr, counts);
            for (int k = 0; k < 3; ++k) direct[k].add(double(seen[Layer::direct][k]));
            caustic.add(double(seen[Layer::caustic].g));
          }
          for (int k = 0; k < 3; ++k) {
            const double expected = double(kReflectance) / M_PI * c.irradiance(floor, double(x), k);
            // One sample has a sigma of at most 2.4 (the choice to pass two panes), scrambled Sobol numbers leave less.
            EXPECT_NEAR(direct[k].mean() / expected, 1, c.exact ? 2e-5 : 0.02)
                << c.name << ", panes " << panes << ", x " << x << ", known " << known;
          }
          if (panes == 1 || c.exact || known) { EXPECT_EQ(caustic.mean(), 0) << c.name << ' ' << panes; }
        }
      }
}

/// The same light at an irradiance point.
TEST(Panes, PointsHoldLightBehindThem) {
  for (const Case& c : cases()) {
    Floor floor(2, c.half);
    c.add(floor);
    const SceneFrame frame = floor.frame();
    const Tracer tracer(frame);
    const Lights lights(frame, build_emission_table({&frame, 1}));
    const Rgb point = test::direct_at(tracer, lights, {1.5f, 0, 0}, c.exact ? 1 : 16384);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(double(point[k]) / c.irradiance(floor, 1.5, k), 1, c.exact ? 2e-5 : 0.01) << c.name;
  }
}

/// Photons that have passed panes alone are direct photons, with the same irradiance. Tolerance: 4 sigma of the number
/// of photons on the floor.
TEST(Panes, PhotonsBehindThemAreDirect) {
  HandMadeScene scene;
  const std::uint32_t ground = scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.5f)));
  Material clear = tinted_pane();
  clear.transmission = 1;  // no Lambert lobe: nothing sends light from the pane back to the floor as indirect light
  scene.add_quad({-3, 1, 3}, {3, 1, 3}, {3, 1, -3}, {-3, 1, -3}, clear);
  scene.add_sun(normalize(Vec3{0.8f, -1, 0}), Rgb(3.0f));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  PhotonOptions options;
  options.photon_count = 200000;
  options.store_direct = true;
  double flux[3] = {};
  int count = 0;
  for (const formats::Photon& photon : test::photons_of(PhotonTracer(tracer, lights, options))) {
    EXPECT_NE(photon.kind, formats::PathKind::caustic);
    if (photon.kind != formats::PathKind::direct || photon.object != ground) continue;
    ++count;
    for (std::size_t k = 0; k < 3; ++k) flux[k] += double(photon.flux[k]);
  }
  ASSERT_GT(count, 5000);
  const double c = 1 / std::sqrt(1.64);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(flux[k] / (4 * 3 * c * (1 - fresnel(c)) * double(kTint[k])), 1, 4 / std::sqrt(count)) << k;
}

/// A pane's drawn passages have the mean that passed_straight() states; other glass never passes light straight.
TEST(Panes, SamplesPassTheStatedShare) {
  for (const float cosine : {1.0f, 0.5f, 0.1f}) {
    const Bsdf bsdf(tinted_pane(), true);
    const Vec3 wo = test::direction(cosine, 0.3f);
    Rgbd mean(0.0);
    constexpr int kCount = 20000;
    for (int i = 0; i < kCount; ++i) {
      const Bsdf::Sample s = bsdf.sample(wo, (float(i) + 0.5f) / kCount, {0.5f, 0.5f});
      if (s.straight) mean += Rgbd(s.weight) / double(kCount);
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(mean[k], double(bsdf.passed_straight(cosine)[k]), 1e-4);
      EXPECT_NEAR(mean[k], double(kShare) * (1 - fresnel(double(cosine))) * double(kTint[k]), 1e-4);
    }
  }
  EXPECT_TRUE(is_black(Bsdf(test::glass(0, false, 1.0f), true).passed_straight(1)));
  EXPECT_TRUE(is_black(Bsdf(test::glass(0.3f, true), true).passed_straight(1)));
  EXPECT_TRUE(is_black(Bsdf(test::matte(Rgb(0.5f)), true).passed_straight(1)));
}

TEST(Panes, AreNoEventBehindALambertLobe) {
  EyePath behind;
  behind.scatter(true);
  behind.pass_straight();
  EXPECT_EQ(behind.layer(), Layer::direct);
  behind.scatter(true);
  EXPECT_EQ(behind.layer(), Layer::indirect);
  EyePath seen;
  seen.pass_straight();
  EXPECT_EQ(seen.layer(), Layer::specular);
}

/// A clear pane that absorbs nothing.
Material clear_pane() { return test::glass(0, true); }

/// The pane keeps all light in the room, so its walls receive F / (S (1 - rho)) in the mean, by whatever mixture of
/// paths, points, caustic photons and gather rays. Tolerances as for GatherInPixels; the pilot of 60000 paths has a
/// noise of 0.5 %.
TEST(Panes, NoLightIsCountedTwiceOrLost) {
  CutRoom room(clear_pane());
  Chain chain(room.scene, 400000, 5000, 64, 16);
  PhotonLightOptions caustics;
  caustics.caustic_only = true;
  const PhotonLight photons(chain.tracer, chain.traced.photons, {}, caustics);
  const auto of = [](const std::array<double, kLayerCount>& mean, Layer layer) {
    return mean[std::size_t(layer)] * M_PI / CutRoom::kRho;
  };
  std::array<double, kLayerCount> path{};
  for (const int mode : {0, 1, 2}) {
    KnownLight known;
    known.points = &chain.lookup;
    if (mode == 2) known.photons = &photons;
    const auto mean = CutRoom::on_walls(chain, mode > 0 ? &known : nullptr, 60000);
    if (mode == 0) path = mean;
    const double all = of(mean, Layer::direct) + of(mean, Layer::caustic) + of(mean, Layer::indirect);
    EXPECT_NEAR(all / CutRoom::kIrradiance, 1, 0.015) << mode;
    for (const Layer layer : {Layer::direct, Layer::indirect})
      EXPECT_NEAR(of(mean, layer) / of(path, layer), 1, 0.02) << mode << kLayerNames[std::size_t(layer)];
    // The pane reflects 4 %, so few paths and photons carry caustic light: a noise of some 8 %.
    EXPECT_NEAR(of(mean, Layer::caustic), of(path, Layer::caustic), 0.3 * of(path, Layer::caustic)) << mode;
    EXPECT_LT(of(mean, Layer::caustic), 0.1 * of(mean, Layer::direct)) << "reflections alone";
  }
  // Gather rays of records find the same indirect light, at points and, where there are none, by going on.
  const PointLookup none({}, 1);
  const FinalGather by_paths(chain.tracer, chain.lights, none, {.rays = 64});
  EXPECT_NEAR(CutRoom::gathered(chain, chain.gather) / of(path, Layer::indirect), 1, 0.02);
  EXPECT_NEAR(CutRoom::gathered(chain, by_paths) / of(path, Layer::indirect), 1, 0.02);
}

/// All walls emit 1 and reflect one half: 2 everywhere, on both sides of the pane and through the pane.
TEST(Panes, AreInvisibleInAFurnace) {
  CutRoom room(clear_pane(), 1);
  const Chain chain(room.scene, 400000, 3000, 4, 16);
  KnownLight known;
  known.points = &chain.lookup;
  for (const bool points : {false, true}) {
    double all = 0;
    for (const double layer : CutRoom::on_walls(chain, points ? &known : nullptr, 40000)) all += layer;
    EXPECT_NEAR(all, 2, 0.01) << points;
  }
  RayCounts counts;
  Mean through;
  for (std::uint32_t i = 0; i < 40000; ++i)
    through.add(
        total(trace_eye_path({chain.tracer, chain.lights}, {{-1.5f, 0, 0}, normalize(Vec3{1, 0.1f, 0.2f}), 0, INFINITY},
                             PixelRandom(3, 0, i), nullptr, counts)));
  EXPECT_NEAR(through.mean(), 2, 4 * through.sigma() + 1e-4);
  EXPECT_LT(through.sigma(), 0.006);
}

/// The same with smoke that only scatters: still 2. Light that smoke sends through the pane is sampled and met, too.
TEST(Panes, AreInvisibleInASmokyFurnace) {
  CutRoom room(clear_pane(), 1);
  MediumOptions smoke;
  smoke.albedo = Rgb(1.0f);
  room.scene.set_media(test::cube_of_medium({0, 0, 0}, 5, smoke));
  const Chain chain(room.scene, 1000, 10, 4);
  const auto path = CutRoom::on_walls(chain, nullptr, 60000);
  double all = 0;
  for (const double layer : path) all += layer;
  EXPECT_NEAR(all, 2, 0.01);
  const PointLookup none({}, 1);
  const FinalGather by_paths(chain.tracer, chain.lights, none, {.rays = 64});
  // The eye sees the walls through 1 cm of smoke with an extinction of 1 / m.
  const double indirect = path[std::size_t(Layer::indirect)] / std::exp(-0.01);
  EXPECT_NEAR(CutRoom::gathered(chain, by_paths) / (indirect * M_PI / CutRoom::kRho), 1, 0.01);
}

/// Photons close to a lamp pass the pane between lamp and floor, too. A point light of I = 1 at height 0.3 m, the pane
/// at 0.2 m: the flux that lands within `reach` = 1 m of the lamp is the integral of T over the directions up to the
/// angle whose cosine c is 0.3; in smoke of extinction s, of T exp(-s 0.3 / c). Seen to fail: smoke from the pane on
/// alone.
TEST(Panes, LampsAreCloseThroughThem) {
  for (const float extinction : {0.0f, 2.0f}) {
    HandMadeScene scene;
    scene.add_quad({-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, matte(Rgb(0.5f)));
    Material clear = tinted_pane();
    clear.transmission = 1;
    scene.add_quad({-9, 0.2f, 9}, {9, 0.2f, 9}, {9, 0.2f, -9}, {-9, 0.2f, -9}, clear);
    scene.add_point_light({0, 0.3f, 0}, Rgb(1.0f));
    if (extinction > 0) scene.set_media(test::cube_of_medium({0, 0, 0}, 4, {.sigma_t = extinction}));
    const SceneFrame& frame = scene.frame();
    const Tracer tracer(frame);
    const Lights lights(frame, build_emission_table({&frame, 1}));
    std::vector<IrradiancePoint> points(1);
    points[0].normal = {0, 1, 0};
    const PointLookup lookup(points, 1 / kBesideLamp);
    double flux = 0, expected = 0;
    for (const LampPhoton& photon : photons_beside_lamps(tracer, lights, lookup)) flux += double(photon.flux.g);
    for (int i = 0; i < 1000; ++i) {
      const double c = 0.3 + 0.7 * (i + 0.5) / 1000;
      expected += 2 * M_PI * 0.7 / 1000 * (1 - fresnel(c)) * double(kTint[1]) * std::exp(-double(extinction) * 0.3 / c);
    }
    EXPECT_NEAR(flux / expected, 1, 0.03) << extinction;
  }
}

}  // namespace
}  // namespace tempolux
