// lib/filter/resolve.h -- composes pixels at edges from the surfaces they see.
#pragma once

#include <vector>

#include "lib/filter/coverage.h"
#include "lib/filter/surfaces.h"

namespace tempolux {

/// One channel of the light of surfaces. Radiance is light times albedo; an empty plane of albedo means 1.
struct EdgePlane {
  const Plane& own;    ///< by pixel: light of the surface at the pixel's centre
  const Plane& other;  ///< by pixel: light of surfaces that no neighbouring centre shows; empty: black
  const Plane& albedo;

  float albedo_at(int x, int y) const { return albedo.empty() ? 1 : albedo.at(x, y); }
  float own_at(int x, int y) const { return own.at(x, y) * albedo_at(x, y); }
  float other_at(int x, int y) const { return other.empty() ? own_at(x, y) : other.at(x, y) * albedo_at(x, y); }
};

/// Writes the radiance of each pixel p. If p sees one surface the radiance is own(p), else
///     share(p) own(p) + sum over the neighbours n of share(n) own(n) + share(other) other(p),
/// with shares from coverage.
void resolve(const EdgePlane& light, const Coverage& coverage, int width, int height, std::vector<float>& values);

}  // namespace tempolux
