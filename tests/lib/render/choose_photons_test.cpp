// How many paths of light a photon map gets: a sky that reaches all of a plate, or a room by a small hole alone.
#include "lib/render/choose_photons.h"

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace tempolux {
namespace {

/// One in 70 or more leaves a photon: the usual number. Fewer: as many more, but 16 times at most; none at all is as one.
TEST(PhotonPaths, AreMoreWhereFewArrive) {
  EXPECT_EQ(photon_paths({70'000, 1'000}, 700'000), 700'000u);
  EXPECT_EQ(photon_paths({70'000, 50'000}, 700'000), 700'000u);
  EXPECT_EQ(photon_paths({70'000, 250}, 700'000), 2'800'000u);
  EXPECT_EQ(photon_paths({70'000, 50}, 100'000), 1'600'000u);
  EXPECT_EQ(photon_paths({32'768, 0}, 700'000), 11'200'000u);
}

/// A plate of 4 m x 4 m under a sun from right above: the disc that sends its light has the plate's diagonal, so 2 / pi of the paths arrive, those that are direct light; that of kind indirect,
/// from one plate, is none. Four standard errors of 32768 paths are 1.1 %.
TEST(PhotonPaths, ArrivalsAreThoseOfTheKindsAsked) {
  test::HandMadeScene scene;
  scene.add_quad({0, 0, 4}, {4, 0, 4}, {4, 0, 0}, {0, 0, 0}, test::matte(Rgb(0.5f)));
  SceneFrame frame = scene.frame();
  PlacedLight sun;
  sun.light.kind = PunctualLight::Kind::directional;
  sun.light.intensity = Rgb(1.0f);
  sun.direction = {0, -1, 0};
  frame.lights.push_back(sun);
  const EmissionTable table = build_emission_table(std::span(&frame, 1));
  const Tracer tracer(frame);
  const Lights lights(frame, table);
  const ArrivalPilot direct = pilot_arrivals({tracer, lights}, "direct", 0), indirect = pilot_arrivals({tracer, lights}, "indirect", 0);
  EXPECT_NEAR(double(direct.photons) / double(direct.paths), 2 / M_PI, 0.02);
  EXPECT_EQ(indirect.photons, 0u);
}

}  // namespace
}  // namespace tempolux
