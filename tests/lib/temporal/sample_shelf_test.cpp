// Samples in a file: places, and what goes wrong.
#include "lib/temporal/sample_shelf.h"

#include <gtest/gtest.h>

#include "formats/error.h"

namespace tempolux {
namespace {

TEST(SampleShelf, APlaceGivenUpIsUsedAgain) {
  SampleShelf shelf(::testing::TempDir(), 12 * 10);
  std::vector<SampleShelf::Place> places(4);
  const auto put = [&](std::size_t i, std::size_t count, std::uint16_t distance) {
    std::vector<formats::RadianceSample> samples(count);
    std::vector<std::uint32_t> anchors(count, distance);
    for (formats::RadianceSample& s : samples) s.distance = distance;
    shelf.put(places[i], samples, anchors);
    return samples.size();
  };
  EXPECT_EQ(put(0, 10, 1), 10u);  // stays
  EXPECT_EQ(put(1, 10, 2), 0u);
  EXPECT_EQ(put(2, 7, 3), 0u);
  EXPECT_EQ(shelf.bytes_in_file(), 12u * 17);
  shelf.give_up(10, places[1]);
  EXPECT_EQ(put(3, 10, 4), 0u);
  EXPECT_EQ(shelf.bytes_in_file(), 12u * 17);
  std::vector<formats::RadianceSample> samples;
  std::vector<std::uint32_t> anchors;
  shelf.fetch(10, places[3], samples, anchors);
  ASSERT_EQ(samples.size(), 10u);
  EXPECT_EQ(samples[9].distance, 4);
  EXPECT_EQ(anchors[9], 4u);
  shelf.fetch(7, places[2], samples, anchors);
  EXPECT_EQ(samples[6].distance, 3);
  shelf.give_up(10, places[0]);
  EXPECT_EQ(shelf.bytes_in_memory(), 0u);
}

TEST(SampleShelf, APlaceWithoutRoomIsNamed) {
  SampleShelf shelf("/proc/no-such-folder", 0);
  SampleShelf::Place place;
  std::vector<formats::RadianceSample> samples(3);
  std::vector<std::uint32_t> anchors(3);
  try {
    shelf.put(place, samples, anchors);
    FAIL();
  } catch (const ResourceError& error) {
    EXPECT_NE(std::string(error.what()).find("/proc/no-such-folder"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace tempolux
