// Channels of the camera: the albedo of a texture whose lines are narrower than a pixel.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/render/data_channels.h"
#include "tests/support/frames.h"
#include "tests/support/textured_scene.h"

namespace tempolux {
namespace {

/// A plane that is seen at a cosine of 1/8 to its normal. Along its slope a pixel is eight times as long as wide and
/// holds two periods of a black and a white stripe; every pixel's centre lies on a white one. The mean is 1/2.
/// Meant to catch: 1, the reflectance at the centre, since the stripes are wider than a pixel is wide.
TEST(DataChannels, AlbedoIsTheMeanOverAPixelThatIsSeenAtASlant) {
  test::HandMadeScene made;
  Material stripes = test::matte(Rgb(1.0f));
  stripes.textures.emplace().base_color = test::texture_of_image();
  made.set_images({test::png_image(1, 2, 3, {255, 255, 255, 0, 0, 0})});
  const float slope = std::sqrt(63.0f);
  const auto at = [&](float x, float y) { return Vec3{x, y, slope * y - 8}; };
  made.add({at(-2, -0.7f), at(2, -0.7f), at(2, 0.7f), at(-2, 0.7f)}, {{0, 1, 2}, {0, 2, 3}}, stripes);
  const auto v = [](float y) { return 64 * y + 0.125f; };  // two periods in a pixel of 1/32 m
  made.set_uvs({{0.5f, v(-0.7f)}, {0.5f, v(-0.7f)}, {0.5f, v(0.7f)}, {0.5f, v(0.7f)}});
  made.add_point_light({0, 0, 3}, Rgb(1.0f));
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  Image image{64, 36, {}, {}, {}, {}};
  add_data_channels({tracer, lights}, test::from_above(), {"albedo"}, {}, {}, image);
  // Pixels that the border between the two triangles crosses take the mean over the part on one of them.
  int right = 0;
  for (const float albedo : image.find("albedo.G")->values) right += std::abs(albedo - 0.5f) < 0.02f;
  EXPECT_GT(right, 64 * 36 - 2 * 64);
}

}  // namespace
}  // namespace tempolux
