// Octahedral normals, as conventions.md defines them.
#include <gtest/gtest.h>

#include <cmath>

#include "formats/photons/photons.h"

namespace tempolux::formats {
namespace {

using Code = std::array<std::uint16_t, 2>;
using Normal = std::array<float, 3>;

double length(Normal n) { return std::sqrt(double(n[0]) * n[0] + double(n[1]) * n[1] + double(n[2]) * n[2]); }

// The table of conventions.md.
TEST(Normals, WorkedValuesOfTheConventions) {
  EXPECT_EQ(encode_normal({0, 0, 1}), (Code{32767, 32767}));
  EXPECT_EQ(encode_normal({1, 0, 0}), (Code{65534, 32767}));
  EXPECT_EQ(encode_normal({-1, 0, 0}), (Code{0, 32767}));
  EXPECT_EQ(encode_normal({0, 1, 0}), (Code{32767, 65534}));
  EXPECT_EQ(encode_normal({0, -1, 0}), (Code{32767, 0}));
  EXPECT_EQ(encode_normal({0, 0, -1}), (Code{65534, 65534}));
  EXPECT_EQ(encode_normal({1, 2, -2}), (Code{52427, 58981}));
  EXPECT_EQ(encode_normal({-0.6f, 0, -0.8f}), (Code{0, 51491}));
}

TEST(Normals, AxesAreExact) {
  for (Normal axis :
       {Normal{1, 0, 0}, Normal{-1, 0, 0}, Normal{0, 1, 0}, Normal{0, -1, 0}, Normal{0, 0, 1}, Normal{0, 0, -1}})
    for (int c = 0; c < 3; ++c) EXPECT_EQ(decode_normal(encode_normal(axis))[c], axis[c]);
}

// Half a step of 1/32767 in both numbers displaces the point of the octahedron by at most 0.5/32767 sqrt(6),
// and the octahedron comes as near as 1/sqrt(3) to its centre: 1.53e-5 * 2.449 * 1.732 = 6.5e-5 rad.
TEST(Normals, AreOffByAtMostHalfAStep) {
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {  // a spiral over the sphere
    const double z = 1 - 2 * (i + 0.5) / 200000, phi = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    const Normal n{float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
    const Normal back = decode_normal(encode_normal(n));
    double d2 = 0;
    for (int c = 0; c < 3; ++c) d2 += (double(n[c]) - back[c]) * (double(n[c]) - back[c]);
    worst = std::max(worst, std::sqrt(d2));
  }
  EXPECT_LT(worst, 6.55e-5);
  EXPECT_GT(worst, 5e-5);
}

TEST(Normals, EveryCodeIsAUnitVectorAndLengthDoesNotMatter) {
  for (int u = 0; u <= 65534; u += 23)
    for (int v = 0; v <= 65534; v += 257) {
      const Normal n = decode_normal({std::uint16_t(u), std::uint16_t(v)});
      ASSERT_NEAR(length(n), 1, 1e-7) << u << " " << v;
      ASSERT_EQ(encode_normal(n), encode_normal({4 * n[0], 4 * n[1], 4 * n[2]}));
    }
}

}  // namespace
}  // namespace tempolux::formats
