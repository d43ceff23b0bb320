// tests/support/sliding_edge.h -- what a picture shows of an edge that slides while the shutter is open.
#pragma once

#include <algorithm>

namespace tempolux::test {

/// Share of pixel column x that lies between `left` and `right`, while both move by `way` pixels around their places.
inline double expected_column(double left, double right, double way, int x) {
  double sum = 0;
  const int times = 10000;
  for (int i = 0; i < times; ++i) {
    const double by = way * ((i + 0.5) / times - 0.5);
    sum += std::max(0.0, std::min(right + by, x + 1.0) - std::max(left + by, double(x)));
  }
  return sum / times;
}

}  // namespace tempolux::test
