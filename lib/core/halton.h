// lib/core/halton.h -- scrambled Halton points with exact integer digits, from which photons start.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace tempolux {

/// Radical inverse in one prime base b with a random permutation of the digits at every position, keyed by (seed, base,
/// position):
///
///     i = sum a_k b^k  ->  sum perm_k(a_k) b^(-k-1),
/// The sum has as many digits as fit into a 64-bit numerator. Digits are looked up in blocks, in tables of at most 2048
/// entries. If two indices agree modulo b^m, their results agree in the first m digits, with or without the
/// permutations; photon groups rely on this (docs/methods/formulas.md). The sum is exact for every 64-bit index and is
/// then rounded once to a value below 1.
class RadicalInverse {
 public:
  /// Every seed, also 0, scrambles; scramble = false gives the plain sequence, for tests.
  RadicalInverse(std::uint32_t base, std::uint64_t seed, bool scramble = true);

  /// The radical inverse of an index, in [0, 1).
  double operator()(std::uint64_t index) const;

 private:
  std::uint32_t block_digits_, block_size_;
  int block_count_;
  std::uint64_t reciprocal_;                  ///< 2^64 / block_size, rounded down
  double scale_;                              ///< base^-(block_digits * block_count)
  std::vector<std::uint32_t> table_;          ///< block_count x block_size: the digits reversed and permuted
  std::vector<std::uint64_t> rest_weight_;    ///< for each number of finished blocks, block_size^(remaining blocks)
  std::vector<std::uint64_t> rest_of_zeros_;  ///< likewise, the remaining blocks' numerator if their digits are all 0
};

/// The four coordinates of a photon's emission in bases 3, 5, 7 and 2, in order of use: choice of the light and
/// position (base 3), position (5), direction (7, 2). All photons of group g = i mod N_g with N_g = 2^a 3^b 5^c 7^d lie
/// in one box of volume 1/N_g.
class PhotonHalton {
 public:
  /// Each seed gives another scrambling.
  explicit PhotonHalton(std::uint64_t seed);
  /// Point of photon `index`: components in [0, 1).
  std::array<double, 4> point(std::uint64_t index) const;

 private:
  RadicalInverse base3_, base5_, base7_, base2_;
};

}  // namespace tempolux
