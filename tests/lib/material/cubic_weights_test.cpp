// Interpolation between four entries of a table: exact for cubics, also in the intervals at both ends.
#include "lib/material/cubic_weights.h"

#include <gtest/gtest.h>

#include <array>

namespace tempolux {
namespace {

// The entries are the values of a cubic at 7 places; floats in [0, 8] leave an error of some 1e-6.
TEST(CubicWeights, ReproduceCubics) {
  const auto cubic = [](float x) { return ((2 * x - 3) * x + 1) * x + 4; };
  std::array<float, 7> table;
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = cubic(float(i) / 6);
  for (const float x : {0.0f, 0.05f, 0.2f, 0.5f, 0.83f, 0.97f, 1.0f}) {
    float weight[4], value = 0;
    const int first = cubic_weights(x, int(table.size()), weight);
    for (int i = 0; i < 4; ++i) value += weight[i] * table[std::size_t(first + i)];
    EXPECT_NEAR(value, cubic(x), 1e-5f) << x;
  }
}

}  // namespace
}  // namespace tempolux
