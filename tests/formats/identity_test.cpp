#include "formats/identity.h"

#include <gtest/gtest.h>

#include <array>

namespace tempolux::formats {
namespace {

const Identity kScene{"g", "m", "a", "l", "v", 0, 23};

TEST(Identity, NamesJustTheConcernsThatDifferAndWereAskedFor) {
  Identity file = kScene;
  EXPECT_EQ(stale_concerns(file, kScene), "");
  file.lights = "other";
  file.media = "other";
  EXPECT_EQ(stale_concerns(file, kScene), "lights, media");
  EXPECT_EQ(stale_concerns(file, kScene, std::array{kConcerns[4], kConcerns[2]}), "media");
}

TEST(Identity, EmissionIsComparedByWhoeverAsksForIt) {
  Identity file = kScene, scene = kScene;
  file.emission = "e";
  EXPECT_EQ(stale_concerns(file, scene, kConcerns), "");
  scene.emission = "other";
  EXPECT_EQ(stale_concerns(file, scene, kConcerns), "emission");
  EXPECT_EQ(stale_concerns(file, scene), "");
}

TEST(Identity, FramesAreNotCompared) {
  Identity file = kScene;
  file.first_frame = file.last_frame = 7;
  EXPECT_EQ(stale_concerns(file, kScene), "");
}

TEST(Identity, UnknownOnEitherSideNeverDiffers) {
  Identity file = kScene;
  file.lights = "";
  EXPECT_EQ(stale_concerns(file, kScene), "");
  EXPECT_EQ(stale_concerns(kScene, file), "");
  const Identity nothing;
  EXPECT_FALSE(nothing.known());
  EXPECT_EQ(stale_concerns(nothing, kScene), "");
  EXPECT_EQ(stale_concerns(kScene, nothing), "");
}

}  // namespace
}  // namespace tempolux::formats
