// lib/material/cubic_weights.h -- cubic Lagrange interpolation between four neighbouring entries of a table.
#pragma once

#include <algorithm>

namespace tempolux {

/// The four entries around a position in [0, 1] of a table of `count` >= 4 entries, where 0 is the first entry and 1
/// the last. Returns the index of the first of the four and sets their Lagrange weights, which sum to 1.
inline int cubic_weights(float position, int count, float weight[4]) {
  const float at = position * float(count - 1);
  const int first = std::clamp(int(at) - 1, 0, count - 4);
  const float s = at - float(first), s1 = s - 1, s2 = s - 2, s3 = s - 3;
  weight[0] = s1 * s2 * s3 * (-1.0f / 6);
  weight[1] = s * s2 * s3 * 0.5f;
  weight[2] = s * s1 * s3 * -0.5f;
  weight[3] = s * s1 * s2 * (1.0f / 6);
  return first;
}

}  // namespace tempolux
