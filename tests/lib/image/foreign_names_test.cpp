// Channels of Blender and Nuke under our names.
#include "lib/image/foreign_names.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tempolux {
namespace {

Image with(std::initializer_list<std::pair<const char*, float>> channels) {
  Image image{1, 1, {}, {}, {}, {}};
  for (const auto& [name, value] : channels) image.add(name).values[0] = value;
  return image;
}

float value_of(const Image& image, const char* name) {
  const Channel* channel = image.find(name);
  return channel ? channel->values[0] : NAN;
}

TEST(ForeignNames, AreThoseOfThePage) {
  for (const auto& [theirs, ours] : {std::pair{"ViewLayer.Combined.R", "R"},
                                     {"Combined.A", "A"},
                                     {"View Layer.Depth.Z", "Z"},
                                     {"depth.Z", "Z"},
                                     {"ViewLayer.Z.Z", "Z"},
                                     {"a.b.Normal.X", "N.X"},
                                     {"ViewLayer.Vector.Y", "backward.v"},
                                     {"ViewLayer.Denoising Albedo.G", "albedo.G"},
                                     {"ViewLayer.Denoising Normal.X", "N.X"},
                                     {"ViewLayer.Denoising Depth.Z", "Z"}})
    EXPECT_EQ(our_name(theirs), ours);
  // Ours, and passes that only sound alike.
  for (const char* name : {"R", "Z", "N.X", "direct.R", "forward.u", "ViewLayer.Noisy Image.R", "ViewLayer.DiffDir.R",
                           "Depth.V", ".Z", "", "Combined"})
    EXPECT_EQ(our_name(name), name);
}

/// The motion that formats/frames/frames.md 7 measured: (+2, +1) from frame 1 to 2, (+4, +3) from 2 to 3.
TEST(ForeignNames, DepthAndMotionMeanWhatOursMean) {
  Image image =
      with({{"V.Depth.Z", 1e10f}, {"V.Vector.X", -2}, {"V.Vector.Y", -1}, {"V.Vector.Z", -4}, {"V.Vector.W", -3}});
  name_as_ours(image);
  EXPECT_EQ(value_of(image, "Z"), INFINITY);
  EXPECT_EQ(value_of(image, "backward.u"), -2);
  EXPECT_EQ(value_of(image, "backward.v"), -1);
  EXPECT_EQ(value_of(image, "forward.u"), 4);
  EXPECT_EQ(value_of(image, "forward.v"), 3);
  EXPECT_EQ(image.channels.front().name, "Z");  // sorted by name, capitals first
}

TEST(ForeignNames, PlainPassesComeBeforeThoseOfDenoisers) {
  Image image = with({{"V.Depth.Z", 3}, {"V.Denoising Depth.Z", 5}, {"V.Denoising Normal.X", 1}});
  name_as_ours(image);
  EXPECT_EQ(value_of(image, "Z"), 3);
  EXPECT_EQ(value_of(image, "V.Denoising Depth.Z"), 5);
  EXPECT_EQ(value_of(image, "N.X"), 1);
}

TEST(ForeignNames, OursComeFirstAndOneViewLayerCounts) {
  Image both = with({{"R", 1}, {"V.Combined.R", 2}});
  name_as_ours(both);
  EXPECT_EQ(value_of(both, "R"), 1);
  EXPECT_EQ(value_of(both, "V.Combined.R"), 2);
  // The picture is layer b's, so the depth must not be layer a's.
  Image layers = with({{"a.Depth.Z", 7}, {"b.Combined.R", 1}, {"b.Depth.Z", 3}, {"c.Combined.R", 5}});
  name_as_ours(layers);
  EXPECT_EQ(value_of(layers, "R"), 1);
  EXPECT_EQ(value_of(layers, "Z"), 3);
  EXPECT_EQ(value_of(layers, "c.Combined.R"), 5);
}

}  // namespace
}  // namespace tempolux
