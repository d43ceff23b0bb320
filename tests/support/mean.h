// tests/support/mean.h -- means of random numbers with their standard errors.
#pragma once

#include <algorithm>
#include <cmath>

namespace tempolux::test {

/// The mean of the numbers added so far, and the standard error of this mean.
struct Mean {
  double sum = 0, square = 0;
  int count = 0;
  void add(double x) { sum += x, square += x * x, ++count; }
  double mean() const { return sum / count; }
  double sigma() const { return std::sqrt(std::max(0.0, square / count - mean() * mean()) / count); }
};

}  // namespace tempolux::test
