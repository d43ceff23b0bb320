// Smoke over a frame of two pixels: its light is added, all light behind it is dimmed once.
#include "lib/compose/smoke_layer.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

Image frame_of_light() {
  Image frame{2, 1, {}, {}, {}, {}};
  for (const char* name : {"R", "G", "B", "A", "Z", "direct.R", "albedo.R", "CryptoObject00.G"})
    frame.add(name).values = {0.5f, 0.5f};
  return frame;
}

const std::vector<SmokePixel> kSmoke{{Rgb(1, 2, 3), 0.5f}, {Rgb(0.0f), 1}};

TEST(SmokeLayer, DimsLightOnceAndAddsItsOwn) {
  Image frame = frame_of_light();
  EXPECT_FALSE(has_smoke(frame));
  add_smoke(kSmoke, false, frame);
  EXPECT_TRUE(has_smoke(frame));
  EXPECT_EQ(frame.find("G")->values, std::vector<float>({2.25f, 0.5f}));
  EXPECT_EQ(frame.find("volume.B")->values, std::vector<float>({3, 0}));
  EXPECT_EQ(frame.find("direct.R")->values, std::vector<float>({0.25f, 0.5f}));
  EXPECT_EQ(frame.find("A")->values, std::vector<float>({0.75f, 0.5f}));  // 1 - .5 (1 - .5)
  for (const char* data : {"Z", "albedo.R", "CryptoObject00.G"})
    EXPECT_EQ(frame.find(data)->values, std::vector<float>({0.5f, 0.5f}));
}

TEST(SmokeLayer, LeavesTheLightOfAnAttenuatedFrame) {
  Image frame = frame_of_light();
  add_smoke(kSmoke, true, frame);
  EXPECT_EQ(frame.find("R")->values, std::vector<float>({1.5f, 0.5f}));
  for (const char* name : {"direct.R", "A"}) EXPECT_EQ(frame.find(name)->values, std::vector<float>({0.5f, 0.5f}));
}

}  // namespace
}  // namespace tempolux
