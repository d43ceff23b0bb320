// tests/lib/aqm/compared_test.cpp -- which channels are compared, what is refused, and difference pictures.
#include "lib/aqm/compared.h"

#include <gtest/gtest.h>

#include <limits>

#include "formats/error.h"
#include "lib/aqm/difference.h"
#include "tests/lib/aqm/synthetic.h"

namespace tempolux {
namespace {

using namespace synthetic;

std::string refusal(const ComparedInputs& inputs) {
  try {
    compare_layers(inputs);
  } catch (const InputError& error) { return error.what(); }
  return "accepted";
}

TEST(ComparedTest, LayersAreColoursSingleChannelsOrGroups) {
  Image image = constant_image(2, 2, 1);
  for (const char* name : {"N.Z", "N.X", "N.Y", "Z", "forward.u", "forward.v"}) image.add(name);
  image.add_ids("id.object");
  EXPECT_EQ(layer_planes({&image, "f"}, "").suffixes, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_EQ(layer_planes({&image, "f"}, "N").suffixes, (std::vector<std::string>{"X", "Y", "Z"}));
  EXPECT_EQ(layer_planes({&image, "f"}, "Z").suffixes, (std::vector<std::string>{""}));
  EXPECT_EQ(layer_planes({&image, "f"}, "forward").suffixes, (std::vector<std::string>{"u", "v"}));
}

TEST(ComparedTest, MissingLayerListsWhatIsThere) {
  Image image = constant_image(2, 2, 1);
  for (const char* name : {"direct.R", "direct.G", "direct.B", "Z"}) image.add(name);
  EXPECT_EQ(refusal({{&image, "a.exr"}, {&image, "b.exr"}, {}, {}, "indirect"}),
            "a.exr: layer indirect is not in this file; it has layers RGB, direct; other channels Z");
}

TEST(ComparedTest, OtherSizesAreRefused) {
  const Image a = constant_image(4, 3, 1), b = constant_image(3, 4, 1);
  EXPECT_EQ(refusal({{&a, "a.exr"}, {&b, "b.exr"}, {}, {}, ""}),
            "b.exr: 3x4 pixels, but a.exr has 4x3; compare frames of one size");
}

TEST(ComparedTest, NonFiniteSamplesAreRefusedWithTheirPlace) {
  const Image good = constant_image(4, 3, 1);
  Image bad = good;
  bad.find("B")->values[6] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(refusal({{&good, "a.exr"}, {&good, "b.exr"}, {&bad, "c.exr"}, {}, ""}),
            "c.exr: layer RGB channel B at column 2, row 1: not a finite number; leave such pixels out with "
            "--mask");
}

TEST(ComparedTest, AnEmptyMaskIsRefused) {
  const Image image = constant_image(4, 3, 1), nothing = constant_image(4, 3, 0);
  EXPECT_EQ(refusal({{&image, "a"}, {&image, "b"}, {}, {&nothing, "mask.exr"}, ""}),
            "mask.exr: leaves no pixel to compare; make it other than 0 where pixels count");
}

TEST(DifferenceTest, IsSignedAgainstTheMeanOfTheHalves) {
  const Image x = constant_image(2, 2, 1), r1 = constant_image(2, 2, 1), r2 = constant_image(2, 2, 2);
  const Image difference = difference_image(compare(x, r1, &r2));
  EXPECT_EQ(difference.find("G")->values, std::vector<float>(4, -0.5f));
}

TEST(DifferenceTest, PictureIsGreyAtZeroRedAboveAndBlueBelow) {
  const Image x = rgb_image(3, 1, [](std::size_t i, std::uint32_t) { return i == 0 ? 1.0 : i == 1 ? 1.5 : 0.75; });
  const Image r = constant_image(3, 1, 1);
  const Picture picture = difference_picture(compare(x, r), 0.5);
  EXPECT_EQ(picture.rgb, (std::vector<std::uint8_t>{128, 128, 128, 255, 0, 0, 64, 64, 192}));
}

// 99 % of the pixels differ by 0.3 or less, one outlier in 256 by 100: the scale is the next of 1, 2, 5 above
// 0.3.
TEST(DifferenceTest, ScaleIsARoundNumberThatIgnoresOutliers) {
  Image x = constant_image(16, 16, 1.3);
  for (const char* name : {"R", "G", "B"}) x.find(name)->values[3] = 101;
  EXPECT_DOUBLE_EQ(difference_scale(compare(x, constant_image(16, 16, 1))), 0.5);
  EXPECT_DOUBLE_EQ(difference_scale(compare(x, x)), 1);
}

}  // namespace
}  // namespace tempolux
