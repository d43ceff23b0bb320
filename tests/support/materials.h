// tests/support/materials.h -- glass, and directions about a normal, for tests of scattering.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/scene/scene.h"

namespace tempolux::test {

/// Clear glass that lets through what it does not reflect.
inline Material glass(float roughness, bool thin = false, float index = 1.5f) {
  Material m;
  m.metallic = 0;
  m.roughness = roughness;
  m.transmission = 1;
  m.ior = index;
  m.thin_walled = thin;
  return m;
}

/// In the local frame of a surface, normal +z.
inline Vec3 direction(float cos_theta, float phi) {
  const float s = std::sqrt(std::max(0.0f, 1 - cos_theta * cos_theta));
  return {s * std::cos(phi), s * std::sin(phi), cos_theta};
}

}  // namespace tempolux::test
