// Scrambled Sobol points: stratified in every elementary box, independent between keys.
#include "lib/core/sobol.h"

#include <gtest/gtest.h>

#include <vector>

#include "lib/core/random.h"

namespace tempolux {
namespace {

TEST(Sobol, FirstPowersOfTwoFillEveryElementaryBox) {
  for (std::uint64_t key : {0ull, 1ull, 0xdeadbeefull})
    for (int k : {1, 2, 4, 6, 8, 10})
      for (int split = 0; split <= k; ++split) {
        std::vector<int> hits(std::size_t(1) << k);
        for (std::uint32_t i = 0; i < (1u << k); ++i) {
          const Vec2 p = sobol_owen_2d(i, key);
          const auto x = unsigned(p.x * float(1 << split)), y = unsigned(p.y * float(1 << (k - split)));
          ++hits[x << (k - split) | y];
        }
        for (int count : hits) ASSERT_EQ(count, 1) << "key " << key << " 2^" << k << " split " << split;
      }
}

TEST(Sobol, AlignedBlocksBeyondTheFirstAreStratifiedToo) {
  std::vector<int> hits(64);
  for (std::uint32_t i = 5 * 64; i < 6 * 64; ++i) {
    const Vec2 p = sobol_owen_2d(i, 99);
    ++hits[unsigned(p.x * 8) * 8 + unsigned(p.y * 8)];
  }
  for (int count : hits) EXPECT_EQ(count, 1);
}

TEST(Sobol, OneDimensionIsStratified) {
  std::vector<int> hits(256);
  for (std::uint32_t i = 0; i < 256; ++i) ++hits[unsigned(sobol_owen_1d(i, 7) * 256)];
  for (int count : hits) EXPECT_EQ(count, 1);
}

/// Two keys as two dimensions: the correlation of n independent pairs has sigma 1/sqrt(n).
TEST(Sobol, KeysAreIndependent) {
  constexpr int kPoints = 1 << 14;
  double correlation = 0;
  for (std::uint32_t i = 0; i < kPoints; ++i)
    correlation += (double(sobol_owen_1d(i, 1000)) - 0.5) * (double(sobol_owen_1d(i, 1001)) - 0.5) * 12;
  EXPECT_NEAR(correlation / kPoints, 0, 4.0 / 128);
}

TEST(PathRandom, NumbersAreUniformAndDifferentPurposesIndependent) {
  constexpr int kNumbers = 1 << 18;
  double mean = 0, product = 0;
  std::vector<int> bins(64);
  for (std::uint32_t i = 0; i < kNumbers; ++i) {
    const PathRandom random(3, i);
    const float a = random.get1(2, Purpose::lobe), b = random.get1(2, Purpose::roulette);
    ASSERT_LT(a, 1.0f);
    mean += double(a);
    product += (double(a) - 0.5) * (double(b) - 0.5);
    ++bins[unsigned(a * 64)];
  }
  EXPECT_NEAR(mean / kNumbers, 0.5, 4 / std::sqrt(12.0 * kNumbers));   // 4 sigma
  EXPECT_NEAR(product / kNumbers, 0, 4.0 / 12 / std::sqrt(kNumbers));  // 4 sigma
  double chi2 = 0;
  for (int n : bins) chi2 += (n - kNumbers / 64.0) * (n - kNumbers / 64.0) / (kNumbers / 64.0);
  EXPECT_LT(chi2, 63 + 5 * std::sqrt(2 * 63.0));  // 5 sigma of chi-square with 63 degrees
}

}  // namespace
}  // namespace tempolux
