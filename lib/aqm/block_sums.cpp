// lib/aqm/block_sums.cpp -- sums over blocks and quotients of sums.
#include "lib/aqm/block_sums.h"

#include <algorithm>
#include <cmath>

namespace tempolux {

BlockGrid::BlockGrid(int width, int height) {
  const double pixels = double(width) * double(height);
  edge_ = std::clamp(int(std::sqrt(pixels / 64)), 1, 16);
  columns_ = (width + edge_ - 1) / edge_;
  rows_ = (height + edge_ - 1) / edge_;
}

std::optional<Estimate> quotient_of_sums(const std::vector<BlockQuotient>& blocks) {
  double numerator = 0, denominator = 0;
  for (const BlockQuotient& block : blocks) {
    numerator += block.numerator;
    denominator += block.denominator;
  }
  const double value = numerator / denominator;
  if (denominator == 0 || !std::isfinite(value)) return std::nullopt;
  if (blocks.size() < 2) return Estimate{value, std::nullopt};

  double squares = 0;
  for (const BlockQuotient& block : blocks) {
    const double residual = block.numerator - value * block.denominator;
    squares += residual * residual;
  }
  const double n = double(blocks.size());
  const double standard_error = std::sqrt(n / (n - 1) * squares) / std::abs(denominator);
  if (!std::isfinite(standard_error)) return Estimate{value, std::nullopt};
  return Estimate{value, standard_error};
}

}  // namespace tempolux
