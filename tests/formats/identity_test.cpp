#include "formats/identity.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace tempolux::formats {
namespace {

const Identity kScene{"g", "m", "a", "l", "v", 0, 23};
const std::vector<std::string_view> kAll{"static_geometry", "moving_geometry", "materials", "lights",
                                         "media"};
using Names = std::vector<std::string>;

TEST(Identity, NamesJustTheConcernsThatDifferAndWereAskedFor) {
  Identity file = kScene;
  EXPECT_EQ(stale_concerns(file, kScene, kAll), Names());
  file.lights = "other";
  file.media = "other";
  EXPECT_EQ(stale_concerns(file, kScene, kAll), (Names{"lights", "media"}));
  EXPECT_EQ(stale_concerns(file, kScene, {"media", "materials"}), Names{"media"});
}

TEST(Identity, EmissionIsComparedByWhoeverAsksForIt) {
  Identity file = kScene, scene = kScene;
  file.emission = "e";
  EXPECT_EQ(stale_concerns(file, scene, {"emission"}), Names());
  scene.emission = "other";
  EXPECT_EQ(stale_concerns(file, scene, {"emission"}), Names{"emission"});
  EXPECT_EQ(stale_concerns(file, scene, kAll), Names());
}

TEST(Identity, FramesAreNotCompared) {
  Identity file = kScene;
  file.first_frame = file.last_frame = 7;
  EXPECT_EQ(stale_concerns(file, kScene, kAll), Names());
}

TEST(Identity, UnknownOnEitherSideNeverDiffers) {
  Identity file = kScene;
  file.lights = "";
  EXPECT_EQ(stale_concerns(file, kScene, kAll), Names());
  EXPECT_EQ(stale_concerns(kScene, file, kAll), Names());
  const Identity nothing;
  EXPECT_FALSE(nothing.known());
  EXPECT_EQ(stale_concerns(nothing, kScene, kAll), Names());
  EXPECT_EQ(stale_concerns(kScene, nothing, kAll), Names());
}

TEST(Identity, RefusesAConcernThatDoesNotExist) {
  EXPECT_THROW(stale_concerns(kScene, kScene, {"camera"}), std::invalid_argument);
}

}  // namespace
}  // namespace tempolux::formats
