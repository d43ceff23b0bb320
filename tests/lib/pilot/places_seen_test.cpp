// Places that a camera sees, in a closed room.
#include "lib/pilot/places_seen.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/frames.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

TEST(PilotPart, NumbersThePartsInRows) {
  EXPECT_EQ(pilot_part(0, 0), 0u);
  EXPECT_EQ(pilot_part(0.999, 0), std::size_t(kPilotColumns - 1));
  EXPECT_EQ(pilot_part(0, 0.999), std::size_t(kPilotParts - kPilotColumns));
  EXPECT_EQ(pilot_part(0.5, 0.5), std::size_t(kPilotRows / 2 * kPilotColumns + kPilotColumns / 2));
}

/// A cube of 2 m around a camera that looks down on its floor. The picture, 2 x 1.125 m, shows only the floor,
/// uniformly: each half of it has half of the places, to a few of the 1024 stratified ones. Cosine-distributed rays
/// from the middle of the floor meet walls and ceiling, never the floor.
TEST(PlacesSeen, AreTheFloorAndThenTheOtherFaces) {
  test::HandMadeScene scene;
  scene.add_room({-1.01f, -1.01f, 0}, {1.01f, 1.01f, 2}, test::matte(Rgb(0.5f)));
  const test::Lit lit(scene.frame());
  constexpr int kLooks = 1024;
  const SeenPlaces seen = places_seen(lit.scene(), test::from_above(), kLooks, 1);
  ASSERT_EQ(seen.places.size(), std::size_t(kLooks));
  int right = 0;
  for (std::size_t i = 0; i < seen.places.size(); ++i) {
    const SeenPlace &place = seen.places[i], &next = seen.next_places[i];
    ASSERT_TRUE(place.exists());
    ASSERT_TRUE(next.exists());
    EXPECT_NEAR(place.surface.position.z, 0, 1e-5);
    EXPECT_NEAR(place.normal.z, 1, 1e-5);
    right += place.surface.position.x > 0;
    EXPECT_GT(next.surface.position.z, 0);
    EXPECT_GT(dot(next.normal, place.surface.position - next.surface.position), 0) << "the side that the ray meets";
  }
  EXPECT_NEAR(right, kLooks / 2, 4);
}

/// Each of two cameras sees half of the places of the other's picture: half of the second picture is new.
TEST(NewShare, OfACameraThatMovesByHalfAPicture) {
  test::HandMadeScene scene;
  scene.add_quad({-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, test::matte(Rgb(0.5f)));
  const Tracer tracer(scene.frame());
  PlacedCamera first = test::from_above().camera(), second = first;
  second.scene_from_camera.translation.x += 1;
  EXPECT_NEAR(new_share(tracer, std::vector{first, second}, 64, 36), 0.5, 4.0 / kPlacesOfEye);
  EXPECT_EQ(new_share(tracer, std::vector{first, first}, 64, 36), 0);
  EXPECT_EQ(new_share(tracer, std::vector{first}, 64, 36), 0);
}

}  // namespace
}  // namespace tempolux
