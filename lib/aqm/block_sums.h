// lib/aqm/block_sums.h -- means over an image with standard errors that include the correlation of neighbouring pixels.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tempolux {

/// A figure and its standard error; no standard error if there is only one block.
struct Estimate {
  double value = 0;
  std::optional<double> standard_error;
  bool operator==(const Estimate&) const = default;
};

/// Cuts the image into about 64 square blocks with edges of 1 to 16 pixels. Errors of rendered pixels are correlated
/// over some pixels (caches, filters, density estimates), but sums over blocks are nearly independent, so their scatter
/// gives a valid standard error.
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

/// The contribution of one block to a quotient of sums.
struct BlockQuotient {
  double numerator = 0, denominator = 0;
};

/// B = sum numerator / sum denominator and its standard error
///     sqrt(n/(n-1) sum_b (numerator_b - B denominator_b)^2) / |sum denominator|,
/// where n is the number of blocks [Cochran, Sampling Techniques, 1977, 2.11]. With pixel counts as denominators this
/// is a mean. Variation of the true error over the image also counts as scatter, so for structured errors the standard
/// error is too large rather than too small. Empty if the denominators sum to zero.
std::optional<Estimate> quotient_of_sums(const std::vector<BlockQuotient>& blocks);

}  // namespace tempolux
