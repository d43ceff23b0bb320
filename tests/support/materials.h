// tests/support/materials.h -- materials of glass, and directions around a normal, for tests of scattering.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/scene/scene.h"

namespace tempolux::test {

/// Clear glass: it transmits all light that it does not reflect.
inline Material glass(float roughness, bool thin = false, float index = 1.5f) {
  Material m;
  m.metallic = 0;
  m.roughness = roughness;
  m.transmission = 1;
  m.ior = index;
  m.thin_walled = thin;
  return m;
}

/// A unit direction in the local frame of a surface, whose normal is +z.
inline Vec3 direction(float cos_theta, float phi) {
  const float s = std::sqrt(std::max(0.0f, 1 - cos_theta * cos_theta));
  return {s * std::cos(phi), s * std::sin(phi), cos_theta};
}

}  // namespace tempolux::test
