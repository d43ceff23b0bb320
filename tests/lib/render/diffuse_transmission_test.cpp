// Paper, leaves, cloth: a Lambert lobe that sends light to the other side. Answers on paper, for the Bsdf, camera
// paths, photons, points and gather rays.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/sobol.h"
#include "lib/material/diffuse_transmission.h"
#include "lib/render/known_light.h"
#include "lib/render/path_tracer.h"
#include "tests/support/cut_room.h"
#include "tests/support/frames.h"
#include "tests/support/layers.h"
#include "tests/support/materials.h"
#include "tests/support/mean.h"

namespace tempolux {
namespace {

using test::Chain;
using test::CutRoom;
using test::HandMadeScene;
using test::matte;
using test::Mean;

constexpr float kShare = 0.6f;               // of the light that is not absorbed
constexpr Rgb kReflected{0.5f, 0.8f, 1.0f};  // colours of both lobes
constexpr Rgb kThrough{0.9f, 0.6f, 0.3f};

/// Paper of the colours above; with a gloss and a coat if `layered`.
Material paper(bool layered = false) {
  Material m = matte(kReflected);
  m.diffuse_transmission = kShare;
  m.diffuse_transmission_color = kThrough;
  m.double_sided = true;
  if (layered) {
    m.specular = 1;
    m.roughness = 0.4f;
    m.clearcoat = 0.5f;
    m.clearcoat_roughness = 0.1f;
  }
  return m;
}
Rgb reflected() { return kReflected * (1 - kShare); }
Rgb through() { return kThrough * kShare; }

/// Uniform light from both sides: A of it is reflected by the lobes above, rho + tau of the rest by the two Lambert
/// lobes. Samples of the transmitting lobe have the same mean. Seen to fail with a coupling of the transmitting lobe
/// that leaves out the coat.
TEST(DiffuseTransmission, LayersAndBothLobesShareTheLight) {
  for (const bool layered : {false, true}) {
    const Bsdf own(paper(layered)), far_side(on_far_side(paper(layered)));
    EXPECT_TRUE(is_black(far_side.specular_albedo(test::direction(0.7f, 1))));
    EXPECT_TRUE(far_side.specular_is_delta());
    for (const float cosine : {1.0f, 0.6f, 0.2f}) {
      const Vec3 wo = test::direction(cosine, 0.4f);
      const Rgb above = own.specular_albedo(wo);
      Rgbd sampled(0.0);
      constexpr std::uint32_t kCount = 1 << 14;
      for (std::uint32_t i = 0; i < kCount; ++i)
        sampled += Rgbd(far_side.sample(wo, sobol_owen_1d(i, 3), sobol_owen_2d(i, 5)).weight) / double(kCount);
      for (int k = 0; k < 3; ++k) {
        const double rest = 1 - double(max_component(above));
        EXPECT_NEAR(own.diffuse_reflectance(wo)[k] + far_side.diffuse_reflectance(wo)[k],
                    double(reflected()[k] + through()[k]) * rest, layered ? 0.02 : 1e-6);
        EXPECT_NEAR(sampled[k], double(far_side.diffuse_reflectance(wo)[k]), layered ? 0.01 : 1e-6);
      }
    }
  }
}

/// f(wi, wo) does not change if light and viewer change places: the viewer is then on the other side, from where both
/// directions are turned round.
TEST(DiffuseTransmission, IsReciprocal) {
  const Bsdf far_side(on_far_side(paper(true)));
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Vec2 u = sobol_owen_2d(i, 9);
    const Vec3 a = test::direction(0.01f + 0.99f * u.x, 1), b = test::direction(0.01f + 0.99f * u.y, 4);
    EXPECT_NEAR(far_side.eval_diffuse(a, b).g, far_side.eval_diffuse(b, a).g, 1e-6f);
  }
}

/// A sheet at y = 0 in the light of a point light at y = 2, seen from 0.5 m above and below.
TEST(DiffuseTransmission, SheetShowsBothSides) {
  HandMadeScene scene;
  scene.add_quad({-50, 0, 50}, {50, 0, 50}, {50, 0, -50}, {-50, 0, -50}, paper());
  scene.add_point_light({0, 2, 0}, Rgb(10.0f));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  RayCounts counts;
  for (const float side : {1.0f, -1.0f})
    for (const float x : {0.0f, 1.5f}) {
      Rgbd mean(0.0);
      constexpr std::uint32_t kCount = 1 << 12;
      for (std::uint32_t i = 0; i < kCount; ++i)
        mean += Rgbd(trace_eye_path({tracer, lights}, {{x, 0.5f * side, 0}, {0, -side, 0}, 0, INFINITY},
                                    PixelRandom(5, 1, i), nullptr, counts)[Layer::direct]) /
                double(kCount);
      const double d2 = 4 + double(x * x), irradiance = 10 * 2 / (d2 * std::sqrt(d2));
      // The side is drawn by stratified numbers: its share errs by 1 / kCount at most.
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(mean[k] * M_PI / irradiance, double((side > 0 ? reflected() : through())[k]), 1e-3) << side;
    }
}

/// Sun on a sheet of 4 m^2 that covers a black box. The box receives E area tau. Tolerance: 4 sigma of the number of
/// photons. Seen to fail without the division by the side's probability.
TEST(DiffuseTransmission, PhotonsPass) {
  HandMadeScene scene;
  scene.add_quad({-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}, paper());
  const Material black = matte(Rgb(0.0f));
  const auto wall = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return scene.add_quad(a, b, c, d, black); };
  const std::uint32_t first = wall({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1});
  wall({-1, 0, -1}, {1, 0, -1}, {1, 1, -1}, {-1, 1, -1});
  wall({-1, 0, 1}, {-1, 1, 1}, {1, 1, 1}, {1, 0, 1});
  wall({-1, 0, -1}, {-1, 1, -1}, {-1, 1, 1}, {-1, 0, 1});
  wall({1, 0, -1}, {1, 0, 1}, {1, 1, 1}, {1, 1, -1});
  scene.add_sun({0, -1, 0}, Rgb(3.0f));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  PhotonOptions options;
  options.photon_count = 200000;
  double flux[3] = {};
  int count = 0;
  for (const formats::Photon& photon : test::photons_of(PhotonTracer(tracer, lights, options))) {
    if (photon.object < first) continue;
    EXPECT_EQ(photon.kind, formats::PathKind::indirect);
    ++count;
    for (std::size_t k = 0; k < 3; ++k) flux[k] += double(photon.flux[k]);
  }
  ASSERT_GT(count, 5000);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(flux[k] / (3 * 4 * double(through()[k])), 1, 4 / std::sqrt(count)) << k;
}

/// The paper keeps all light in the room, so the walls receive F / (S (1 - rho)) in the mean: by paths, by points, and
/// by gather rays, whose part is what remains without direct light. Tolerances: the paths' noise is .4 %, that of
/// 400000 photons and 64 rays .5 %. Seen to fail by 20 % if gather rays take the paper for a wall that only reflects.
TEST(DiffuseTransmission, NoLightIsCountedTwiceOrLost) {
  for (const float share : {kShare, 1.0f}) {
    Material white = matte(Rgb(1.0f));
    white.diffuse_transmission = share;
    CutRoom room(white);
    Chain chain(room.scene, 400000, 5000, 64, 16);
    KnownLight known;
    known.points = &chain.lookup;
    for (const KnownLight* const light : {static_cast<KnownLight*>(nullptr), &known}) {
      const auto seen = CutRoom::on_walls(chain, light, 60000);
      const double all = seen[std::size_t(Layer::direct)] + seen[std::size_t(Layer::indirect)];
      EXPECT_NEAR(all * M_PI / CutRoom::kRho / CutRoom::kIrradiance, 1, 0.015) << share;
    }
    // The photons' indirect light is all light but what the glowing wall sends to the other walls directly.
    const PointLookup none({}, 1);
    const FinalGather by_paths(chain.tracer, chain.lights, none, {.rays = 64});
    EXPECT_NEAR(CutRoom::gathered(chain, chain.gather) / CutRoom::gathered(chain, by_paths), 1, 0.02) << share;
  }
}

/// Both sides of the paper are seen for records: some looks of a pixel choose the far side.
TEST(DiffuseTransmission, RecordsAreWantedOnBothSides) {
  HandMadeScene scene;
  Material white = paper();
  white.base_color = white.diffuse_transmission_color = Rgb(1.0f);
  scene.add_quad({-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}, white);
  const Tracer tracer(scene.frame());
  const CameraView view = test::from_above();
  int near = 0, far = 0;
  for (std::size_t pixel = 0; pixel < 256; ++pixel)
    for (std::uint32_t k = 0; k < kEdgeLooks; ++k) {
      const auto seen = seen_through(tracer, view, edge_look(pixel, view.width(), k));
      ASSERT_TRUE(seen.has_value());
      EXPECT_TRUE(seen->by_choice);
      ++(seen->normal.z > 0 ? near : far);
    }
  EXPECT_NEAR(double(far) / (near + far), double(kShare), 0.06);  // 4 sigma of 1024 choices
}

}  // namespace
}  // namespace tempolux
