// Blur made from a sharp frame, against formulas on paper.
#include "lib/filter/blur.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tempolux {
namespace {

/// 64 x 32 pixels of depth 4 m with a flow that is given per pixel.
struct Sharp {
  Image image{64, 32, {}, {}, {}, {}};
  Sharp() {
    for (const char* name : {"R", "G", "B", "Z", "forward.u", "forward.v", "backward.u", "backward.v"}) image.add(name);
    image.add_ids("id.object");
    std::ranges::fill(image.find("Z")->values, 4.0f);
  }
  static std::size_t at(int x, int y) { return std::size_t(64 * y + x); }
  float& of(const char* name, int x, int y) { return image.find(name)->values[at(x, y)]; }
  /// Puts a pixel on another object in front of the wall.
  void front(int x, int y, float z) {
    of("Z", x, y) = z;
    image.find("id.object")->ids[at(x, y)] = 1;
  }
  void colour(int x, int y, float value) {
    for (const char* name : {"R", "G", "B"}) of(name, x, y) = value;
  }
  /// Calls body(x, y) for the pixels of the columns from `left` to before `right`.
  template <class Body>
  static void each(int left, int right, const Body& body) {
    for (int y = 0; y < 32; ++y)
      for (int x = left; x < right; ++x) body(x, y);
  }
  /// Puts a white bar of the depth z [m] into these columns.
  void white_bar(int left, int right, float z) {
    each(left, right, [&](int x, int y) {
      colour(x, y, 1);
      front(x, y, z);
    });
  }
  Image blurred(const BlurOptions& options) const {
    return blur_frame(image, FlowFrame(image, 64, 32, "frame"), options);
  }
};

double column(const Image& image, int x) {
  double sum = 0;
  for (int y = 8; y < 24; ++y) sum += image.find("G")->values[Sharp::at(x, y)];
  return sum / 16;
}

/// Share of pixel column x that lies between `left` and `right`, while both move by `from` to `to` pixels.
double expected_column(double left, double right, double from, double to, int x) {
  double sum = 0;
  const int times = 10000;
  for (int i = 0; i < times; ++i) {
    const double by = from + (to - from) * (i + 0.5) / times;
    sum += std::max(0.0, std::min(right + by, x + 1.0) - std::max(left + by, double(x)));
  }
  return sum / times;
}

/// A white bar in front of a black wall moves by 8 pixels a frame, with the shutter open for half of it. A column has
/// 16 rows of 32 samples: standard error .02 if they were independent. Shifts in whole pixels of the right mean square
/// give a ramp of 4 pixels the steps 1/9, 1/3, 2/3, 8/9 in place of 1/8, 3/8 ...: .042. What the bar uncovers is taken
/// from beside it. Meant to catch: ramps on one side of the edge only, a flow that is followed backwards (the shutter
/// that opens at the frame's time).
TEST(Blur, AMovingBarHasRamps) {
  Sharp sharp;
  sharp.white_bar(20, 40, 2);
  Sharp::each(20, 40, [&](int x, int y) {
    sharp.of("forward.u", x, y) = 8;
    sharp.of("backward.u", x, y) = -8;
  });
  for (const auto& [opens, closes] : {std::pair{-0.25, 0.25}, {0.0, 0.5}}) {
    const Image image = sharp.blurred({opens, closes, 0, 1});
    for (int x = 2; x < 62; ++x)
      EXPECT_NEAR(column(image, x), expected_column(20, 40, 8 * opens, 8 * closes, x), 0.062) << x << " " << opens;
  }
}

/// A white line of a wall that moves by m pixels becomes a strip with the variance m^2 / 12, also if m is below a
/// pixel. 8 samples of time in strata: m^2 / 12 / 64 off at most, and as much by their jitter.
TEST(Blur, ALineBecomesAStripOfTheRightWidth) {
  for (const float way : {0.3f, 1.0f, 5.0f}) {
    Sharp sharp;
    Sharp::each(0, 64, [&](int x, int y) {
      sharp.colour(x, y, x == 32 ? 1 : 0);
      sharp.of("forward.u", x, y) = way;
      sharp.of("backward.u", x, y) = -way;
    });
    const Image image = sharp.blurred({-0.5, 0.5, 0, 1});
    double sum = 0, square = 0;
    for (int x = 0; x < 64; ++x) {
      sum += column(image, x);
      square += column(image, x) * (x - 32) * (x - 32);
    }
    EXPECT_NEAR(sum, 1, 0.02) << way;
    EXPECT_NEAR(square / sum, way * way / 12, 0.04 * way * way / 12) << way;
  }
}

/// A white line on a wall off the focus becomes a strip of the disc's profile: across it, a disc of radius R has the
/// variance R^2 / 4. Its light stays. 32 samples a pixel, jittered over 16 rows: 3 %.
TEST(Blur, APointBecomesADisc) {
  Sharp sharp;
  for (int y = 0; y < 32; ++y) sharp.colour(32, y, 1);
  const double radius = 12 * std::abs(1 / 4.0 - 1 / 2.0) * 2;
  const Image image = sharp.blurred({0, 0, 24, 2});
  double sum = 0, square = 0;
  for (int x = 0; x < 64; ++x) {
    sum += column(image, x);
    square += column(image, x) * (x - 32) * (x - 32);
  }
  EXPECT_NEAR(sum, 1, 0.03);
  EXPECT_NEAR(square / sum, radius * radius / 4, 0.05 * radius * radius / 4 + 1 / 6.0);  // 1/6: rounding to pixels
}

/// A bar in focus before a wall that is not: the wall's light does not cover the bar, and the bar's does not leak into
/// the wall. Meant to catch: discs without depth order.
TEST(Blur, WhatIsInFocusStaysSharp) {
  Sharp sharp;
  Sharp::each(0, 64, [&](int x, int y) {
    const bool bar = x >= 24 && x < 32;
    if (bar) sharp.front(x, y, 1);
    sharp.colour(x, y, bar ? 0.0f : 1.0f);
  });
  const Image image = sharp.blurred({0, 0, 10, 1});
  for (int x = 0; x < 64; ++x) EXPECT_NEAR(column(image, x), x >= 24 && x < 32 ? 0 : 1, 1e-6) << x;
}

/// A bar off the focus before a sharp wall has soft edges on both sides of the edge: half its light at the edge.
TEST(Blur, WhatIsInFrontCoversWhatIsBehind) {
  Sharp sharp;
  sharp.white_bar(20, 44, 1);
  const Image image = sharp.blurred({0, 0, 8, 4});  // radius 6
  EXPECT_NEAR((column(image, 19) + column(image, 20)) / 2, 0.5, 0.05);
  EXPECT_NEAR((column(image, 43) + column(image, 44)) / 2, 0.5, 0.05);
  EXPECT_NEAR(column(image, 16) + column(image, 23), 1, 0.05);
  EXPECT_GT(column(image, 16), 0.05);
  EXPECT_NEAR(column(image, 8), 0, 1e-6);
  EXPECT_NEAR(column(image, 32), 1, 1e-6);
}

TEST(Blur, NothingIsBlurredWhereNothingMoves) {
  Sharp sharp;
  Sharp::each(0, 64, [&](int x, int y) { sharp.colour(x, y, float(x * y % 7)); });
  const Image image = sharp.blurred({-1, 1, 0, 1});
  EXPECT_EQ(image.find("R")->values, sharp.image.find("R")->values);
}

/// Numbers at the ends of their range leave no NaN.
TEST(Blur, EndsOfTheRange) {
  Sharp sharp;
  Sharp::each(0, 64, [&](int x, int y) {
    sharp.colour(x, y, x == 9 ? 3e38f : 1.0f);
    sharp.of("Z", x, y) = x < 20 ? 0.0f : x < 40 ? 1e-30f : INFINITY;
    sharp.of("forward.u", x, y) = y < 9 ? 3e38f : 1e4f;
    sharp.of("backward.v", x, y) = y < 20 ? -3e38f : 5.0f;
  });
  for (const double focus : {1e-6, 1.0, double(INFINITY)}) {
    const Image image = sharp.blurred({-50, 50, 1e9, focus});
    for (const float value : image.find("R")->values) EXPECT_TRUE(std::isfinite(value));
  }
}

}  // namespace
}  // namespace tempolux
