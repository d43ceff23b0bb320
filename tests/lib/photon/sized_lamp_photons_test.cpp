// Photons of a lamp with a size that holds surfaces: the same light as by light samples, inside and outside.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/pi.h"
#include "lib/core/sobol.h"
#include "lib/photon/photon_trace.h"
#include "tests/support/places.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

constexpr Vec3 kUp{0, 1, 0};

/// A floor, and a black sheet at the height 2.1. A lamp of 1 W/sr at the height 2.
test::HandMadeScene pierced() {
  test::HandMadeScene scene;
  for (const float y : {0.0f, 2.1f})
    scene.add_quad({-9, y, -9}, {-9, y, 9}, {9, y, 9}, {9, y, -9}, test::matte(Rgb(0.0f)));
  scene.add_point_light({0, 2, 0}, Rgb(1.0f));
  return scene;
}

/// Flux [W] of the photons that land on the disc of this radius at the height y, on both sides.
double landed(const std::vector<formats::Photon>& photons, float y, float radius) {
  double flux = 0;
  for (const formats::Photon& p : photons)
    if (std::abs(p.position[1] - y) < 1e-3f && std::hypot(p.position[0], p.position[2]) < radius)
      flux += double(p.flux[1]);
  return flux;
}

/// Both sides of the sheet lie inside of the sphere within r = sqrt(.5^2 - .1^2), where each receives I / .5^2 = 4. The
/// floor receives what light samples bring with shadow rays: the lamp's lower part, unhindered by the sheet. All flux
/// is emitted, stored or escapes. 2^18 photons err by less than 1 %. Seen to fail: photons that start on the near side
/// alone (nothing inside); those that start on the far side alone (the floor gets too little); the coin's factor 2 left
/// out.
TEST(SizedLampPhotons, LightWhatIsInsideAndOutside) {
  test::HandMadeScene scene = pierced();
  SceneFrame frame = scene.frame();
  frame.lights[0].light.size.radius_m = 0.5f;
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  const PhotonTracer photons(tracer, lights, {.photon_count = 1 << 18});
  std::vector<formats::Photon> stored;
  Rgbd emitted{0.0}, gone{0.0};
  for (std::size_t b = 0; b < photons.batch_count(); ++b) {
    const PhotonBatch batch = photons.trace(b);
    stored.insert(stored.end(), batch.block.photons.begin(), batch.block.photons.end());
    emitted += batch.emitted;
    gone += batch.escaped + batch.absorbed;
  }
  EXPECT_NEAR(landed(stored, 2.1f, std::sqrt(0.24f)) / (2 * 4 * kPiD * 0.24), 1, 0.01);
  EXPECT_NEAR(gone.g / emitted.g, 1, 1e-6);

  constexpr float kReach = 1.5f;
  double sum = 0;
  constexpr std::uint32_t kPlaces = 1 << 16;
  for (std::uint32_t i = 0; i < kPlaces; ++i) {
    const Vec2 at = sample_disc_concentric(sobol_owen_2d(i, 1));
    const SurfacePoint place = test::place_at({at.x * kReach, 0, at.y * kReach}, kUp);
    LightSample s;
    if (!lights.sample(place.position, kUp, 0.5f, sobol_owen_2d(i, 2), s)) continue;
    if (!tracer.occluded(spawn_shadow_ray(place, s.position, s.position_offset)))
      sum += double(s.facing_irradiance.g * s.wi.y);
  }
  EXPECT_NEAR(landed(stored, 0, kReach) / (sum / kPlaces * kPiD * double(kReach * kReach)), 1, 0.01);
}

}  // namespace
}  // namespace tempolux
