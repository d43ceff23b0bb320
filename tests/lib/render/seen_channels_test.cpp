// What mirrors show: depths on paper.
#include "lib/render/data_channels.h"

#include <gtest/gtest.h>

#include "tests/support/frames.h"

namespace tempolux {
namespace {

/// The camera looks down from z = 1, orthographic. At z = 0 lies a mirror on the left and a matte floor on the right; a
/// matte ceiling of reflectance .25 hangs at z = 3.
Image seen_of_mirror(bool asked) {
  test::HandMadeScene made;
  Material mirror;
  mirror.base_color = Rgb(1.0f);
  mirror.metallic = 1;
  mirror.roughness = 0;
  const auto quad = [](float left, float right, float z) {
    return std::vector<Vec3>{{left, -2, z}, {right, -2, z}, {right, 2, z}, {left, 2, z}};
  };
  made.add(quad(-2, 0, 0), {{0, 1, 2}, {0, 2, 3}}, mirror);
  made.add(quad(0, 2, 0), {{0, 1, 2}, {0, 2, 3}}, test::matte(Rgb(0.5f)));
  made.add(quad(-0.5f, 2, 3), {{0, 1, 2}, {0, 2, 3}}, test::matte(Rgb(0.25f)));
  made.add_point_light({0, 0, 2}, Rgb(1.0f));
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  Image image{64, 36, {}, {}, {}, {}};
  add_seen_channels({tracer, lights}, test::from_above(), {asked ? "seen" : "Z"}, image);
  return image;
}

/// The ray goes 1 m down and 3 m up: the ceiling's image lies 4 m below the camera. Outside the ceiling's edge (x <
/// -.5, column 16) nothing is seen. On the right the floor itself is seen at 1 m; layer specular holds none of its
/// light: its albedo is 1.
TEST(SeenChannels, AMirrorShowsWhatIsAboveIt) {
  const Image image = seen_of_mirror(true);
  const auto at = [&](const char* name, int x) { return image.find(name)->values[std::size_t(18 * 64 + x)]; };
  EXPECT_NEAR(at("seen.Z", 24), 4, 1e-4f);
  EXPECT_NEAR(at("seen.albedo.G", 24), 0.25f, 1e-4f);
  EXPECT_NEAR(at("seen.N.Z", 24), -1, 1e-5f);  // the side that the ray meets
  EXPECT_EQ(at("seen.Z", 4), 0);
  EXPECT_EQ(at("seen.albedo.G", 4), 1);
  EXPECT_NEAR(at("seen.Z", 48), 1, 1e-5f);
  EXPECT_NEAR(at("seen.N.Z", 48), 1, 1e-5f);
  EXPECT_EQ(at("seen.albedo.G", 48), 1);
  const auto& ids = image.find("seen.id")->ids;
  EXPECT_NE(ids[18 * 64 + 24], ids[18 * 64 + 4]);
  EXPECT_NE(ids[18 * 64 + 24], ids[18 * 64 + 48]);
  EXPECT_EQ(ids[18 * 64 + 24], ids[18 * 64 + 28]);
}

TEST(SeenChannels, NotAskedForTheyAreNotThere) { EXPECT_TRUE(seen_of_mirror(false).channels.empty()); }

}  // namespace
}  // namespace tempolux
