#include "lib/image/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace tempolux {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Image two_by_two(std::vector<float> values) {
  Image image;
  image.width = image.height = 2;
  image.add("R").values = std::move(values);
  return image;
}

TEST(ChannelStatistics, AreOfTheFiniteValues) {
  Image image = two_by_two({1, -3, kInfinity, kNan});
  image.add_ids("id.object").ids = {7, 0, 0, 4294967295u};
  const auto all = channel_statistics(image);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].min, -3);
  EXPECT_EQ(all[0].max, 1);
  EXPECT_EQ(all[0].mean, -1);
  EXPECT_EQ(all[0].infinities, 1u);
  EXPECT_EQ(all[0].nans, 1u);
  EXPECT_EQ(all[0].zeros, 0u);
  EXPECT_TRUE(all[1].ids);
  EXPECT_EQ(all[1].max, 4294967295.0);
  EXPECT_EQ(all[1].zeros, 2u);
}

TEST(ChannelStatistics, OfNothingFiniteAreZero) {
  const auto all = channel_statistics(two_by_two({kNan, kNan, kInfinity, -kInfinity}));
  EXPECT_EQ(all[0].min, 0);
  EXPECT_EQ(all[0].max, 0);
  EXPECT_EQ(all[0].mean, 0);
}

TEST(ChannelDifferences, NameTheFirstPixelOfTheLargest) {
  const auto all = channel_differences(two_by_two({0, 1, 2, 3}), two_by_two({0, 1.5f, 1, 4}));
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].differing, 3u);
  EXPECT_EQ(all[0].largest, 1);
  EXPECT_EQ(all[0].x, 0);
  EXPECT_EQ(all[0].y, 1);
}

TEST(ChannelDifferences, NanEqualsNanAndNothingElse) {
  const auto all = channel_differences(two_by_two({kNan, kNan, kInfinity, 0}), two_by_two({kNan, 1, 5, -0.0f}));
  EXPECT_EQ(all[0].differing, 2u);
  EXPECT_EQ(all[0].largest, 0) << "only finite differences have a size";
}

TEST(ChannelDifferences, RefuseOtherSizes) {
  Image other;
  other.width = 4;
  other.height = 1;
  EXPECT_THROW(channel_differences(two_by_two({0, 0, 0, 0}), other), std::invalid_argument);
}

TEST(SequenceExposure, IsTheLowerMedianSoThatOneFlashDoesNotCount) {
  EXPECT_EQ(sequence_exposure_stops({1, -9, 2}), 1);
  EXPECT_EQ(sequence_exposure_stops({4, 1, 3, 2}), 2);
  EXPECT_THROW(sequence_exposure_stops({}), std::invalid_argument);
}

TEST(PointColor, IsTheSrgbTransferOfFluxOverWhite) {
  // sRGB: 0.5 -> 0.7354 -> 188; 1 and more -> 255; below 0 -> 0 (IEC 61966-2-1)
  EXPECT_EQ(point_color({0.5f, 2, -1}, 1), (std::array<std::uint8_t, 3>{188, 255, 0}));
  EXPECT_EQ(point_color({1, 1, 1}, 0), (std::array<std::uint8_t, 3>{0, 0, 0}));
}

}  // namespace
}  // namespace tempolux
