#include "lib/image/frame_identity.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

TEST(FrameIdentity, ComesBackByConcern) {
  Image image;
  set_identity(image, {"g", "m", "a", "", "v", 7, 7});
  EXPECT_EQ(image.text.at("tempolux:identity.static_geometry"), "g");  // frames.md 3
  EXPECT_EQ(image.text.at("tempolux:identity.lights"), "");
  EXPECT_EQ(identity_in(image), (formats::Identity{"g", "m", "a", "", "v", 0, 0}));
}

TEST(FrameIdentity, IsNotKnownWithoutAHash) {
  Image image;
  EXPECT_FALSE(identity_in(image).known());
  set_identity(image, {});
  EXPECT_FALSE(identity_in(image).known());
  image.text["tempolux:identity.media"] = "v";
  EXPECT_TRUE(identity_in(image).known());
}

}  // namespace
}  // namespace tempolux
