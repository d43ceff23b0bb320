// Glass and mirrors along whole paths against closed forms: slab, absorbing cube, rough furnace, corridor of mirrors.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/material/bsdf.h"
#include "lib/render/path_tracer.h"
#include "lib/trace/solid_around.h"
#include "tests/support/layers.h"
#include "tests/support/materials.h"
#include "tests/support/mean.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::glass;
using test::HandMadeScene;
using test::matte;
using test::Mean;
using test::total;

/// A screen at z = -3 that glows with radiance 1 towards +z.
void add_screen(HandMadeScene& scene) {
  scene.add_quad({-40, -40, -3}, {40, -40, -3}, {40, 40, -3}, {-40, 40, -3}, matte(Rgb(0.0f), Rgb(1.0f)));
}

/// Mean radiance (green) along one ray.
Mean look(HandMadeScene& scene, Vec3 from, Vec3 towards, int samples) {
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  RayCounts counts;
  Mean mean;
  for (int i = 0; i < samples; ++i) {
    const Layers seen = trace_eye_path({tracer, lights}, {from, normalize(towards), 0, INFINITY},
                                       PixelRandom(5, 0, std::uint32_t(i)), nullptr, counts);
    mean.add(total(seen));
  }
  return mean;
}

double fresnel(double cos_o, double index) {
  const double c = std::sqrt(1 - (1 - cos_o * cos_o) / (index * index));
  const double rs = (cos_o - index * c) / (cos_o + index * c), rp = (index * cos_o - c) / (index * cos_o + c);
  return (rs * rs + rp * rp) / 2;
}

/// A camera in coloured water looks down at a matte floor 1 m below, under a lamp beside the camera: Beer's law over 2
/// m.
TEST(GlassPaths, CameraInsideASolidSeesThroughIt) {
  HandMadeScene scene;
  Material water = glass(0);
  water.attenuation_color = Rgb(0.5f);
  water.attenuation_distance = 1;
  scene.add_box({-9, -9, -9}, {9, 9, 9}, water);
  scene.add_quad({-4, -1, 4}, {4, -1, 4}, {4, -1, -4}, {-4, -1, -4}, matte(Rgb(0.5f)));
  scene.add_point_light({0.01f, 0, 0}, Rgb(1.0f));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  const RenderScene seen{tracer, lights, false, Inside(SolidAround(tracer)({0, 0, 0}, {}, 0))};
  RayCounts counts;
  const Layers light =
      trace_eye_path(seen, {{0, 0, 0}, {0, -1, 0}, 0, INFINITY}, PixelRandom(5, 0, 0), nullptr, counts);
  EXPECT_NEAR(double(light[Layer::direct].g), 0.5 / M_PI * 0.25, 1e-3);
}

/// A slab 0.2 m thick with the transmittance a along the path inside: T = (1-F)^2 a / (1 - F^2 a^2). The radiance is
/// the screen's times T. 20000 paths of value 0 or 1 have a sigma of 0.0035 at most, and 1 % of T is 3 sigma.
TEST(GlassPaths, SlabLetsThroughTheFresnelSeries) {
  for (double color : {1.0, 0.3})
    for (double angle : {0.0, 0.9, 1.3}) {
      HandMadeScene scene;
      Material m = glass(0);
      m.attenuation_color = Rgb(float(color));
      m.attenuation_distance = color < 1 ? 0.25f : INFINITY;
      scene.add_box({-4, -4, -0.1f}, {4, 4, 0.1f}, m);
      add_screen(scene);
      const double f = fresnel(std::cos(angle), 1.5), inside = std::sqrt(1 - std::pow(std::sin(angle) / 1.5, 2));
      const double a = std::pow(color, 0.2 / inside / 0.25), expected = (1 - f) * (1 - f) * a / (1 - f * f * a * a);
      const Mean seen =
          look(scene, {-float(std::tan(angle)), 0, 1.1f}, {float(std::sin(angle)), 0, -float(std::cos(angle))}, 20000);
      EXPECT_NEAR(seen.mean(), expected, 4 * seen.sigma() + 1e-5) << color << ' ' << angle;
      EXPECT_LT(seen.sigma(), 0.011 * expected + 1e-3);
    }
}

/// A room with radiance 1 on all sides and a solid of rough, clear glass in it: the radiance is 1 for any roughness.
TEST(GlassPaths, RoughGlassInAFurnaceIsInvisible) {
  for (float roughness : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f}) {
    HandMadeScene scene;
    scene.add_room({-2, -2, -2}, {2, 2, 2}, matte(Rgb(0.0f), Rgb(1.0f)));
    scene.add_box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, glass(roughness));
    const Mean seen = look(scene, {1.5f, 0.4f, 1.2f}, {-1.4f, -0.3f, -1}, 40000);
    // 0.005 is the required accuracy for a few boundaries per path
    EXPECT_NEAR(seen.mean(), 1, 0.005 + 3 * seen.sigma()) << roughness;
    EXPECT_LT(seen.sigma(), 0.006) << roughness;
    RecordProperty("mean_" + std::to_string(roughness), std::to_string(seen.mean()));
  }
}

/// Two facing mirrors of reflectance r and a glowing wall behind the eye at the end of n reflections: r^n.
TEST(GlassPaths, CorridorOfMirrorsIsAPower) {
  HandMadeScene scene;
  Material mirror;
  mirror.base_color = Rgb(0.9f);
  mirror.roughness = 0;
  scene.add_quad({-5, -1, -1}, {5, -1, -1}, {5, 1, -1}, {-5, 1, -1}, mirror);
  scene.add_quad({5, -1, 1}, {-5, -1, 1}, {-5, 1, 1}, {5, 1, 1}, mirror);
  scene.add_quad({5, -1, -1}, {5, -1, 1}, {5, 1, 1}, {5, 1, -1}, matte(Rgb(0.0f), Rgb(1.0f)));
  // tan = 1/2 between planes 2 m apart: a reflection every metre of x, the first after half of it (from z = 0).
  const Mean seen = look(scene, {-4.4f, 0, 0}, {0.5f, 0, 1}, 20000);  // x = 5 after 9.4 m: 19 crossings at 0.5 m + k
  const double cos_o = 1 / std::sqrt(1.25), k = std::pow(1 - cos_o, 5), r = 0.9 * (1 - k) + k;
  const int n = int((9.4 - 0.5) / 1) + 1;
  EXPECT_NEAR(seen.mean(), std::pow(r, n), 4 * seen.sigma() + 1e-5);
}

/// A thin rough pane in front of a lamp 0.4 m square: the integral of f cos over the lamp, on a grid. Light sampling on
/// both sides and scattering are joined; no light may count twice.
TEST(GlassPaths, ThinRoughPaneShowsTheLampBehind) {
  for (float roughness : {0.15f, 0.4f, 1.0f}) {
    HandMadeScene scene;
    Material pane = glass(roughness);
    pane.thin_walled = true;
    scene.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, pane);
    scene.add_quad({-0.2f, -0.2f, -1}, {0.2f, -0.2f, -1}, {0.2f, 0.2f, -1}, {-0.2f, 0.2f, -1},
                   matte(Rgb(0.0f), Rgb(1.0f)));
    const Vec3 travel = normalize(Vec3{0.3f, 0, -1});
    const Bsdf bsdf(pane, true);
    double expected = 0;
    constexpr int kGrid = 200;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const Vec3 to{0.4f * ((float(i) + 0.5f) / kGrid - 0.5f), 0.4f * ((float(j) + 0.5f) / kGrid - 0.5f), -1};
        const Vec3 wi = normalize(to);
        expected += double(bsdf.eval_specular(wi, -travel).g) * std::pow(double(-wi.z), 4) * 0.16 /
                    (kGrid * kGrid);  // cos^2 / d^2
      }
    const Mean seen = look(scene, travel * -1.0f, travel, 20000);
    EXPECT_NEAR(seen.mean(), expected, 4 * seen.sigma() + 1e-4 * expected) << roughness;
    EXPECT_LT(seen.sigma(), 0.02 * expected) << roughness;
  }
}

}  // namespace
}  // namespace tempolux
