// Plates of glass (closed solids of two parallel faces) let light pass straight: which solids are plates, the shares
// that they reflect and pass, and light behind them, which is direct light. Answers on paper.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/material/bsdf.h"
#include "lib/photon/photon_trace.h"
#include "lib/points/irradiance_points.h"
#include "lib/render/path_tracer.h"
#include "lib/trace/plates.h"
#include "tests/support/frames.h"
#include "tests/support/layers.h"
#include "tests/support/materials.h"
#include "tests/support/mean.h"
#include "tests/support/photons.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::Mean;

constexpr double kIndex = 1.5;
constexpr float kTint[3] = {0.9f, 0.7f, 0.5f}, kThickness = 0.02f;

Material tinted_glass() {
  Material m = test::glass(0);
  m.base_color = {kTint[0], kTint[1], kTint[2]};
  m.attenuation_color = {0.5f, 0.8f, 1.0f};
  m.attenuation_distance = kThickness;
  return m;
}

/// R and T of a plate, light by light: `way` counts the passages from face to face.
struct Series {
  double reflected = 0, passed = 0;
  Series(double cos_o, int channel) {
    const double c = std::sqrt(1 - (1 - cos_o * cos_o) / (kIndex * kIndex));
    const double rs = (cos_o - kIndex * c) / (cos_o + kIndex * c), rp = (kIndex * cos_o - c) / (kIndex * cos_o + c),
                 f = (rs * rs + rp * rp) / 2, tint = double(kTint[channel]),
                 a = std::pow(channel == 0   ? 0.5
                              : channel == 1 ? 0.8
                                             : 1.0,
                              1 / c);
    reflected = f;
    double inside = tint * (1 - f);
    for (int way = 1; way < 600; ++way) {
      inside *= a;
      (way % 2 ? passed : reflected) += inside * (1 - f) * tint;
      inside *= f;
    }
  }
};

/// The thickness of the plate that a scene's first surface is; 0: it is none.
float thickness_of(HandMadeScene& scene) {
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  return tracer.is_plate(0) ? tracer.surface_point({1, 0, 0, 0.25f, 0.25f}).plate : 0;
}

using Corners = std::vector<Vec3>;
/// A box 1 m wide and 1 cm thick whose upper corners are moved.
HandMadeScene box(const Material& material, Vec3 moved = {}, std::size_t leave_out = 0, const Corners& normals = {}) {
  HandMadeScene scene;
  const float h = 0.01f;
  Corners p{{0, 0, 0}, {1, 0, 0}, {1, h, 0}, {0, h, 0}, {0, 0, 1}, {1, 0, 1}, {1, h, 1}, {0, h, 1}};
  p[2] += moved;
  p[6] += moved;
  std::vector<std::array<std::uint32_t, 3>> faces{{3, 6, 2}, {3, 7, 6}, {0, 1, 5}, {0, 5, 4}, {0, 2, 1}, {0, 3, 2},
                                                  {4, 5, 6}, {4, 6, 7}, {0, 7, 3}, {0, 4, 7}, {1, 2, 6}, {1, 6, 5}};
  faces.resize(faces.size() - leave_out);
  scene.add(p, faces, material, false, normals);
  return scene;
}

/// Meant to catch: without the test of the edges an open box is a plate; with a tilt of 1e-2 allowed the wedge is one.
TEST(Plates, AreClosedSolidsOfTwoParallelFaces) {
  const Material clear = test::glass(0);
  HandMadeScene plate = box(clear), wedge = box(clear, {0, 0.003f, 0}), open = box(clear, {}, 2);
  EXPECT_NEAR(thickness_of(plate), 0.01f, 1e-7f);
  EXPECT_EQ(thickness_of(wedge), 0) << "faces 3e-3 rad apart";
  EXPECT_EQ(thickness_of(open), 0);
  HandMadeScene smooth = box(clear, {}, 0, Corners(8, normalize(Vec3{1, 1, 1})));
  EXPECT_EQ(thickness_of(smooth), 0) << "shading normals of a rounded box";
  HandMadeScene cube, ball;
  cube.add_box({0, 0, 0}, {1, 1, 1}, clear);
  ball.add_sphere({0, 0, 0}, 1, 8, clear, false, false);
  EXPECT_EQ(thickness_of(cube), 0);
  EXPECT_EQ(thickness_of(ball), 0);
  for (const float thick : {0.024f, 0.03f}) {  // the rim is 4 t / (2 + 4 t) of the area: 1/20 at t = .0263
    HandMadeScene slab;
    slab.add_box({0, 0, 0}, {1, thick, 1}, clear);
    EXPECT_EQ(thickness_of(slab) > 0, thick < 0.0263f) << thick;
  }
}

TEST(Plates, AreSmoothAndTransmitAllLight) {
  Material rough = test::glass(0.3f), thin = test::glass(0, true), half = test::glass(0), clear = test::glass(0);
  half.transmission = 0.5f;
  for (const Material& material : {rough, thin, half}) {
    HandMadeScene scene = box(material);
    EXPECT_EQ(thickness_of(scene), 0);
  }
  HandMadeScene stained = box(tinted_glass());
  EXPECT_GT(thickness_of(stained), 0);
}

/// A puddle with the ground inside is none, nor one with the ground at its lower face; a frame around the border may
/// lie inside. What moves does not decide.
TEST(Plates, AreFree) {
  const auto with = [](Vec3 lower, Vec3 upper, bool moving) {
    HandMadeScene scene = box(test::glass(0));
    scene.add_box(lower, upper, matte(Rgb(0.5f)), moving);
    return thickness_of(scene) > 0;
  };
  EXPECT_FALSE(with({-9, -1, -9}, {9, 0.005f, 9}, false));
  EXPECT_FALSE(with({-9, -1, -9}, {9, 0.00005f, 9}, false));
  EXPECT_TRUE(with({-9, -1, -9}, {9, 0.005f, 9}, true));
  EXPECT_TRUE(with({-9, -1, -9}, {9, -0.001f, 9}, false));
  EXPECT_TRUE(with({-9, -1, -9}, {9, 1, 0.05f}, false));
}

/// Meant to catch: with tint where tint^2 belongs in R, by .02; without the cosine in the absorption, by .1.
TEST(Plates, SharesAreTheSumsOverAllReflections) {
  const Bsdf outer(tinted_glass(), true, kThickness), inner(tinted_glass(), false, kThickness);
  for (const float cosine : {1.0f, 0.5f, 0.1f, 0.01f})
    for (int k = 0; k < 3; ++k) {
      const Series exact(double(cosine), k);
      EXPECT_NEAR(double((outer.passed_straight(cosine) * inner.passed_straight(cosine))[k]), exact.passed, 1e-5);
      double reflected = 0, passed = 0;
      constexpr int kCount = 20000;
      for (int i = 0; i < kCount; ++i) {
        const Bsdf::Sample s = outer.sample(test::direction(cosine, 0.3f), (float(i) + 0.5f) / kCount, {0.5f, 0.5f});
        (s.straight ? passed : reflected) += double(s.weight[k]) / kCount;
      }
      EXPECT_NEAR(reflected, exact.reflected, 1e-4);
      EXPECT_NEAR(passed * double(kTint[k]), exact.passed, 1e-4);
    }
}

/// A floor of 100 m below a plate of 100 m at y = 1.
HandMadeScene floor_below_plate(float half) {
  HandMadeScene scene;
  scene.add_quad({-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}, matte(Rgb(0.5f)));
  scene.add_box({-half, 1, -half}, {half, 1 + kThickness, half}, tinted_glass());
  return scene;
}

struct Shone {
  const char* name;
  bool sun, point, sky;
  /// Irradiance on the floor below (0, 2, 0).
  double expected(int k) const {
    const double c = 1 / std::sqrt(1.64);
    if (sun) return 3 * c * Series(c, k).passed;
    if (point) return 10.0 / 4 * Series(1, k).passed;
    double sum = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) sum += Series((i + 0.5) / kSteps, k).passed * (i + 0.5) / kSteps / kSteps;
    return 3 * 2 * M_PI * sum;
  }
};
constexpr Shone kLights[] = {{"sun", true, false, false}, {"point", false, true, false}, {"sky", false, false, true}};

/// Layers of a camera path that starts below the plate, and the irradiance of a point. Light that the plate reflects
/// back to the floor is caustic and comes from the lit floor, which is a layer of its own (indirect).
/// Meant to catch: with plates switched off all light is caustic.
TEST(Plates, LightBehindThemIsDirect) {
  Environment sky;
  sky.radiance = {Rgb(3.0f)};
  for (const Shone& light : kLights) {
    HandMadeScene scene = floor_below_plate(light.sky ? 2000.0f : 50.0f);
    if (light.sun) scene.add_sun(normalize(Vec3{0.8f, -1, 0}), Rgb(3.0f));
    if (light.point) scene.add_point_light({0, 2, 0}, Rgb(10.0f));
    SceneFrame frame = scene.frame();
    if (light.sky) frame.environment = &sky;
    const Tracer tracer(frame);
    const Lights lights(frame, build_emission_table({&frame, 1}));
    RayCounts counts;
    Mean direct[3], caustic;
    const std::uint32_t samples = light.sky ? 16384 : 16;
    for (std::uint32_t i = 0; i < samples; ++i) {
      const Layers seen = trace_eye_path({tracer, lights}, {{0, 0.5f, 0}, {0, -1, 0}, 0, INFINITY},
                                         PixelRandom(5, 1, i), nullptr, counts);
      for (int k = 0; k < 3; ++k) direct[k].add(double(seen[Layer::direct][k]));
      caustic.add(double(seen[Layer::caustic].g));
    }
    const Rgb point = test::direct_at(tracer, lights, {0, 0, 0}, light.sky ? 16384 : 1);
    for (int k = 0; k < 3; ++k) {
      const double expected = light.expected(k), tolerance = light.sky ? 0.02 : 5e-5;
      EXPECT_NEAR(direct[k].mean() * M_PI / 0.5 / expected, 1, tolerance) << light.name;
      EXPECT_NEAR(double(point[k]) / expected, 1, tolerance) << light.name;
    }
    EXPECT_EQ(caustic.mean(), 0) << light.name;
  }
}

/// The sun's flux on a part of the floor: by a plate as direct photons, by the same box with a side open, which
/// refracts, as caustic photons. Tolerance: 4 sigma of their number.
TEST(Plates, PhotonsBringAsMuchAsThroughARefractingSolid) {
  for (const bool closed : {true, false}) {
    HandMadeScene scene = box(tinted_glass(), {}, closed ? 0 : 2);
    const std::uint32_t ground = scene.add_quad({0.1f, -0.1f, 0.9f}, {0.9f, -0.1f, 0.9f}, {0.9f, -0.1f, 0.1f},
                                                {0.1f, -0.1f, 0.1f}, matte(Rgb(0.0f)));
    scene.add_sun(normalize(Vec3{0.6f, -1, 0}), Rgb(3.0f));
    const SceneFrame& frame = scene.frame();
    const Tracer tracer(frame);
    ASSERT_EQ(tracer.is_plate(0), closed);
    const Lights lights(frame, build_emission_table({&frame, 1}));
    PhotonOptions options;
    options.photon_count = 200000;
    options.store_direct = true;
    const double c = 1 / std::sqrt(1.36), c_inside = std::sqrt(1 - (1 - c * c) / (kIndex * kIndex));
    double flux = 0;
    int count = 0;
    for (const formats::Photon& photon : test::photons_of(PhotonTracer(tracer, lights, options))) {
      if (photon.object != ground || photon.position[0] < 0.2f) continue;
      EXPECT_EQ(photon.kind, closed ? formats::PathKind::direct : formats::PathKind::caustic);
      flux += double(photon.flux[1]);
      ++count;
    }
    // The box is 1 cm thick, and attenuation_distance is 2 cm.
    const double f = [&] {
      const double rs = (c - kIndex * c_inside) / (c + kIndex * c_inside),
                   rp = (kIndex * c - c_inside) / (kIndex * c + c_inside);
      return (rs * rs + rp * rp) / 2;
    }();
    const double a = std::pow(0.8, 0.5 / c_inside),
                 passed = double(kTint[1] * kTint[1]) * (1 - f) * (1 - f) * a / (1 - f * f * a * a);
    ASSERT_GT(count, 5000);
    EXPECT_NEAR(flux / (0.7 * 0.8 * 3 * c * passed), 1, 4 / std::sqrt(count)) << closed;
  }
}

}  // namespace
}  // namespace tempolux
