// Photons through glass: what a lens lets through, what a solid absorbs, and that the path tracer sees the same light.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/photon/photon_trace.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;

Material glass(float roughness, Rgb color = Rgb(1.0f), float distance = INFINITY) {
  Material m;
  m.metallic = 0;
  m.roughness = roughness;
  m.transmission = 1;
  m.ior = 1.5f;
  m.thin_walled = false;
  m.attenuation_color = color;
  m.attenuation_distance = distance;
  return m;
}
void add_box(HandMadeScene& scene, Vec3 l, Vec3 u, const Material& m) {
  scene.add({{l.x, l.y, l.z}, {u.x, l.y, l.z}, {u.x, u.y, l.z}, {l.x, u.y, l.z}, {l.x, l.y, u.z}, {u.x, l.y, u.z}, {u.x, u.y, u.z}, {l.x, u.y, u.z}},
            {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4}, {3, 6, 2}, {3, 7, 6}, {0, 7, 3}, {0, 4, 7}, {1, 2, 6}, {1, 6, 5}}, m);
}

struct Stored {
  double direct = 0, caustic = 0, indirect = 0, emitted = 0, gone = 0;   ///< W, green
  std::size_t caustic_count = 0;
};
Stored trace(HandMadeScene& scene, std::uint64_t count, std::uint32_t object) {
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  PhotonOptions options;
  options.photon_count = count;
  const PhotonTracer photons(tracer, lights, options);
  Stored sum;
  for (std::size_t b = 0; b < photons.batch_count(); ++b) {
    const PhotonBatch batch = photons.trace(b);
    for (const formats::Photon& photon : batch.block.photons) {
      if (photon.object != object) continue;
      const double flux = double(photon.flux[1]);
      (photon.kind == formats::PathKind::direct ? sum.direct : photon.kind == formats::PathKind::caustic ? sum.caustic : sum.indirect) += flux;
      sum.caustic_count += photon.kind == formats::PathKind::caustic;
    }
    sum.emitted += batch.emitted.g;
    sum.gone += batch.absorbed.g + batch.escaped.g;
  }
  return sum;
}

/// A black ceiling lamp shines down on a window of glass in a closed frame; below it a black floor. Light that arrives
/// is what comes to the slab times its transmittance: integral of T(theta) over the lamp's light, here a point
/// lamp 1 m above a slab so wide that all its light downwards within 60 degrees meets it.
TEST(Caustics, SlabPassesWhatFresnelSays) {
  for (float color : {1.0f, 0.4f}) {
    HandMadeScene scene;
    add_box(scene, {-40, -0.1f, -40}, {40, 0.1f, 40}, glass(0, Rgb(color), color < 1 ? 0.2f : INFINITY));
    const std::uint32_t floor = scene.add_quad({-400, -2, 400}, {400, -2, 400}, {400, -2, -400}, {-400, -2, -400}, matte(Rgb(0.0f)));
    scene.add_point_light({0, 1.1f, 0}, Rgb(1.0f));
    // Flux 2 pi integral T(mu) dmu over the light downwards that the slab meets: to 40 m, mu from 0.025.
    double expected = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double mu = 0.025 + 0.975 * (i + 0.5) / kSteps, c = std::sqrt(1 - (1 - mu * mu) / 2.25);
      const double rs = (mu - 1.5 * c) / (mu + 1.5 * c), rp = (1.5 * mu - c) / (1.5 * mu + c), f = (rs * rs + rp * rp) / 2;
      const double a = color < 1 ? std::pow(double(color), 0.2 / c / 0.2) : 1;
      expected += 2 * M_PI * (1 - f) * (1 - f) * a / (1 - f * f * a * a) * 0.975 / kSteps;
    }
    const Stored stored = trace(scene, 400000, floor);
    // 200000 photons that arrive or not: 0.2 %; what goes around the rim (direct) is not counted. 1 %.
    EXPECT_NEAR(stored.caustic / expected, 1, 0.01) << color;
    EXPECT_EQ(stored.indirect, 0);
    EXPECT_NEAR(stored.gone, stored.emitted, 1e-6 * stored.emitted);
  }
}

/// A glowing furnace wall and a cube of rough glass: whatever the roughness, the walls get what they give. Walls of
/// area 6 x 16 m^2 emit pi W/m^2 and absorb all: flux stored = emitted, times 1 for any glass.
TEST(Caustics, RoughGlassLosesNoPhotons) {
  for (float roughness : {0.0f, 0.2f, 0.6f, 1.0f}) {
    HandMadeScene closed;
    Material wall = matte(Rgb(0.0f), Rgb(1.0f));
    wall.double_sided = false;
    closed.add_room({-2, -2, -2}, {2, 2, 2}, wall);
    add_box(closed, {-1.2f, -1.2f, -1.2f}, {1.2f, 1.2f, 1.2f}, glass(roughness));
    const Stored stored = trace(closed, 200000, 0);
    EXPECT_NEAR((stored.direct + stored.caustic) / stored.emitted, 1, 0.005) << roughness;
    EXPECT_GT(stored.caustic_count, 10000u);
  }
}

/// Nothing but matte surfaces: no photon of kind caustic.
TEST(Caustics, MatteScenesHaveNone) {
  HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.7f)));
  scene.add_point_light({0, 0, 0}, Rgb(1.0f));
  const Stored stored = trace(scene, 20000, 0);
  EXPECT_EQ(stored.caustic_count, 0u);
  EXPECT_GT(stored.direct, 0);
}

}  // namespace
}  // namespace tempolux
