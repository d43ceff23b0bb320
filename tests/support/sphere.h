// tests/support/sphere.h -- uniform directions on the sphere.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/core/sampling.h"

namespace tempolux::test {

/// Uniform direction on the sphere; pdf_solid_angle is 1/(4 pi).
inline Vec3 sample_sphere(Vec2 u) {
  const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace tempolux::test
