#include "lib/core/halton.h"

#include <cmath>
#include <numeric>

#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kMaxTable = 2048;

/// Random permutation of 0 .. base-1 for one digit position (Fisher-Yates on counter-based numbers).
std::vector<std::uint32_t> digit_permutation(std::uint32_t base, std::uint64_t seed, std::uint32_t position) {
  std::vector<std::uint32_t> permutation(base);
  std::iota(permutation.begin(), permutation.end(), 0u);
  const PathRandom random(seed, base);
  for (std::uint32_t i = base - 1; i > 0; --i) {
    const std::uint64_t bits = random.bits(position, Purpose::scramble, i);
    const auto j = std::uint32_t((bits >> 32) * (i + 1) >> 32);
    std::swap(permutation[i], permutation[j]);
  }
  return permutation;
}

/// Upper 64 bits of a times b.
std::uint64_t high_product(std::uint64_t a, std::uint64_t b) {
  __extension__ using Product = unsigned __int128;
  return std::uint64_t(Product{a} * b >> 64);
}

}  // namespace

RadicalInverse::RadicalInverse(std::uint32_t base, std::uint64_t seed, bool scramble)
    : block_digits_(1), block_size_(base), block_count_(0) {
  while (std::uint64_t(block_size_) * base <= kMaxTable) {
    block_size_ *= base;
    ++block_digits_;
  }
  // The largest number of blocks whose numerator, below block_size^block_count, fits into 64 bits.
  for (std::uint64_t power = 1; power <= ~0ull / block_size_; power *= block_size_) ++block_count_;
  scale_ = std::pow(double(block_size_), -block_count_);
  // 2^64 / block_size; the 1 is added only if block_size divides 2^64.
  reciprocal_ = ~0ull / block_size_ + (~0ull % block_size_ == block_size_ - 1 ? 1 : 0);

  table_.resize(std::size_t(block_count_) * block_size_);
  for (int block = 0; block < block_count_; ++block) {
    std::vector<std::vector<std::uint32_t>> permutations;
    for (std::uint32_t digit = 0; digit < block_digits_; ++digit) {
      const std::uint32_t position = std::uint32_t(block) * block_digits_ + digit;
      permutations.push_back(digit_permutation(base, seed, position));
      if (!scramble) std::iota(permutations.back().begin(), permutations.back().end(), 0u);
    }
    for (std::uint32_t value = 0; value < block_size_; ++value) {
      std::uint32_t rest = value, reversed = 0;
      for (std::uint32_t digit = 0; digit < block_digits_; ++digit, rest /= base)
        reversed = reversed * base + permutations[digit][rest % base];
      table_[std::size_t(block) * block_size_ + value] = reversed;
    }
  }

  rest_weight_.assign(std::size_t(block_count_) + 1, 1);
  rest_of_zeros_.assign(std::size_t(block_count_) + 1, 0);
  for (std::size_t done = std::size_t(block_count_); done-- > 0;) {
    rest_of_zeros_[done] = table_[done * block_size_] * rest_weight_[done + 1] + rest_of_zeros_[done + 1];
    rest_weight_[done] = rest_weight_[done + 1] * block_size_;
  }
}

double RadicalInverse::operator()(std::uint64_t index) const {
  std::uint64_t numerator = 0;
  const std::uint32_t* table = table_.data();
  std::size_t done = 0;
  for (; index != 0 && done < rest_weight_.size() - 1; ++done, table += block_size_) {
    // Since index < 2^64, index * reciprocal / 2^64 is the quotient or one less.
    std::uint64_t quotient = high_product(index, reciprocal_), digits = index - quotient * block_size_;
    if (digits >= block_size_) digits -= block_size_, ++quotient;
    numerator = numerator * block_size_ + table[digits];
    index = quotient;
  }
  const double value = double(numerator * rest_weight_[done] + rest_of_zeros_[done]) * scale_;
  return value < 1 ? value : 0x1.fffffffffffffp-1;
}

PhotonHalton::PhotonHalton(std::uint64_t seed) : base3_(3, seed), base5_(5, seed), base7_(7, seed), base2_(2, seed) {}

std::array<double, 4> PhotonHalton::point(std::uint64_t index) const {
  return {base3_(index), base5_(index), base7_(index), base2_(index)};
}

}  // namespace tempolux
