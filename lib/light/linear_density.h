// lib/light/linear_density.h -- samples a density that is linear over [0, 1].
#pragma once

#include <algorithm>
#include <cmath>

namespace tempolux {

/// Linear interpolation: a at t = 0, b at t = 1.
inline double lerp(double a, double b, double t) { return a + (b - a) * t; }

/// Draws x in [0, 1] with a pdf in proportion to a (1 - x) + b x, from u in [0, 1]; a and b >= 0; uniform if both are
/// 0.
inline double sample_linear(double a, double b, double u) {
  if (!(a + b > 0) || !(u > 0)) return u;  // with u = a = 0 the quotient below would be 0 / 0
  // The root of (b - a) x^2 / 2 + a x = u (a + b) / 2, in the form without cancellation.
  const double x = u * (a + b) / (a + std::sqrt(lerp(a * a, b * b, u)));
  return std::clamp(x, 0.0, 1.0);
}

}  // namespace tempolux
