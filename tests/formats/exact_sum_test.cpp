#include "formats/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tempolux::formats {
namespace {

double sum_of(const std::vector<float>& values) {
  ExactSum sum;
  for (float value : values) sum.add(value);
  return sum.rounded();
}

TEST(ExactSum, OfNothingAndOfOneIsThatValue) {
  EXPECT_EQ(sum_of({}), 0.0);
  for (float value : {0.0f, -0.0f, 1.0f, -1.0f, 0.1f, 1e-45f, -1e-45f, 1.17549435e-38f, 1e38f, -3.4028235e38f})
    EXPECT_EQ(sum_of({value}), double(value)) << value;
  for (int e = -149; e < 128; ++e) EXPECT_EQ(sum_of({std::ldexp(1.0f, e)}), std::ldexp(1.0, e)) << e;
}

// 1e30 + 1 - 1e30 is 1 on paper; float64 sums in this order give 0.
TEST(ExactSum, LosesNothingBetweenLargeAndSmall) {
  EXPECT_EQ(sum_of({1e30f, 1.0f, -1e30f}), 1.0);
  EXPECT_EQ(sum_of({3e38f, 1e-45f, -3e38f}), double(1e-45f));
  EXPECT_EQ(sum_of({-3e38f, -1e-45f, 3e38f}), -double(1e-45f));
}

// 2^53 + 1 lies between two float64 values: the tie goes to the even one, a grain more goes up.
TEST(ExactSum, IsRoundedOnceToNearestEven) {
  const float big = 0x1p53f;
  EXPECT_EQ(sum_of({big, 1.0f}), 0x1p53);
  EXPECT_EQ(sum_of({big, 2.0f, 1.0f}), 0x1p53 + 4);
  EXPECT_EQ(sum_of({big, 1.0f, 1e-45f}), 0x1p53 + 2);
  EXPECT_EQ(sum_of({big, 1.0f, -1e-45f}), 0x1p53);
  EXPECT_EQ(sum_of({-big, -1.0f, -1e-45f}), -0x1p53 - 2);
}

TEST(ExactSum, HasNoOrderAndJoins) {
  std::vector<float> values;
  for (int i = 0; i < 20000; ++i) values.push_back(std::sin(float(i)) * std::ldexp(1.0f, i % 150 - 100));
  const double forwards = sum_of(values);
  ExactSum left, right;
  for (std::size_t i = 0; i < values.size(); ++i) (i % 3 ? left : right).add(values[i]);
  left.add(right);
  std::reverse(values.begin(), values.end());
  EXPECT_EQ(sum_of(values), forwards);
  EXPECT_EQ(left.rounded(), forwards);
}

// 10^8 times 2^-40 is 9e-5 beside 2^20, where float32 adds nothing of it and float64 rounds each term.
TEST(ExactSum, OfHundredMillionTinyTermsBesideALargeOneIsExact) {
  volatile float tiny = 0x1p-40f;  // volatile: else the compiler multiplies
  ExactSum sum;
  sum.add(0x1p20f);
  for (int i = 0; i < 100000000; ++i) sum.add(tiny);
  EXPECT_EQ(sum.rounded(), 0x1p20 + 1e8 * 0x1p-40);
  ExactSum subnormal;
  tiny = 1e-45f;
  for (int i = 0; i < 100000000; ++i) subnormal.add(tiny);
  EXPECT_EQ(subnormal.rounded(), 1e8 * double(1e-45f));
}

// 2^20 times the largest float: the counters must not overflow where the sum of float32 would.
TEST(ExactSum, OfManyHugeValuesIsFinite) {
  ExactSum sum;
  for (int i = 0; i < 1 << 20; ++i) sum.add(std::numeric_limits<float>::max());
  EXPECT_EQ(sum.rounded(), std::ldexp(double(std::numeric_limits<float>::max()), 20));
}

}  // namespace
}  // namespace tempolux::formats
