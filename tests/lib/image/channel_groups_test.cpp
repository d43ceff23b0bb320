// Channels by the names of groups.
#include "lib/image/channel_groups.h"

#include <gtest/gtest.h>

#include "formats/error.h"

namespace tempolux {
namespace {

TEST(ChannelGroups, NamesAreTakenWhole) {
  EXPECT_TRUE(is_in_group("R", "RGBA"));
  EXPECT_FALSE(is_in_group("direct.R", "RGBA"));
  EXPECT_TRUE(is_in_group("indirect.B", "layers"));
  EXPECT_FALSE(is_in_group("diffuse.variance.R", "layers"));
  EXPECT_FALSE(is_in_group("albedo.R", "layers"));
  EXPECT_TRUE(is_in_group("id.object", "id"));
  EXPECT_FALSE(is_in_group("idle", "id"));
  EXPECT_TRUE(is_in_group("backward.v", "motion"));
  EXPECT_TRUE(is_in_group("coverage", "coverage"));
  EXPECT_TRUE(is_in_group("coverage.other", "coverage"));
  EXPECT_TRUE(is_in_group("N.X", "N"));
  EXPECT_FALSE(is_in_group("N.X", "X"));
}

TEST(ChannelGroups, WhatIsNotNamedGoesAndWhatIsNotThereIsSaid) {
  Image image{2, 1, {}, {}, {}, {}};
  for (const char* name : {"B", "G", "N.X", "R", "Z"}) image.add(name);
  EXPECT_THROW(keep_channels({"RGBA", "P"}, image), InputError);
  keep_channels({"Z", "RGBA"}, image);
  ASSERT_EQ(image.channels.size(), 4u);
  EXPECT_EQ(image.channels[0].name, "B");
  EXPECT_EQ(image.channels[3].name, "Z");
}

}  // namespace
}  // namespace tempolux
