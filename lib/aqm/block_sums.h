// lib/aqm/block_sums.h -- means over an image with standard errors that allow for neighbours erring together.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tempolux {

/// A figure and its standard error; no standard error where there is but one block.
struct Estimate {
  double value = 0;
  std::optional<double> standard_error;
  bool operator==(const Estimate&) const = default;
};

/// The image cut into square blocks of 1 to 16 pixels edge, as large as leaves about 64 of them. Errors of
/// rendered pixels are correlated over some pixels (caches, filters, density estimates); sums over blocks are
/// nearly independent, so their scatter gives an honest standard error.
class BlockGrid {
 public:
  BlockGrid() = default;
  BlockGrid(int width, int height);
  std::size_t count() const { return std::size_t(columns_) * std::size_t(rows_); }
  std::size_t block_of(int x, int y) const {
    return std::size_t(y / edge_) * std::size_t(columns_) + std::size_t(x / edge_);
  }
  int edge() const { return edge_; }
  bool operator==(const BlockGrid&) const = default;

 private:
  int edge_ = 1, columns_ = 0, rows_ = 0;
};

/// What one block contributes to a quotient of sums.
struct BlockQuotient {
  double numerator = 0, denominator = 0;
};

/// B = sum numerator / sum denominator and its standard error
///     sqrt(n/(n-1) sum_b (numerator_b - B denominator_b)^2) / |sum denominator|,
/// n the number of blocks given [Cochran, Sampling Techniques, 1977, 2.11]. With pixel counts as denominators
/// this is a mean. The scatter over the image of a true error counts as well, so for structured errors the
/// standard error is too large rather than too small. Nothing if the denominators sum to zero.
std::optional<Estimate> quotient_of_sums(const std::vector<BlockQuotient>& blocks);

}  // namespace tempolux
