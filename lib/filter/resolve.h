// lib/filter/resolve.h -- pixels at edges put together from the surfaces they see.
#pragma once

#include <vector>

#include "lib/filter/coverage.h"
#include "lib/filter/surfaces.h"

namespace tempolux {

/// One channel of the light of surfaces: radiance is light times albedo (an empty plane: 1).
struct EdgePlane {
  const Plane& own;    ///< by pixel: of its own surface
  const Plane& other;  ///< of what no centre around shows; an empty plane: black
  const Plane& albedo;

  float albedo_at(int x, int y) const { return albedo.empty() ? 1 : albedo.at(x, y); }
  float own_at(int x, int y) const { return own.at(x, y) * albedo_at(x, y); }
  float other_at(int x, int y) const { return other.empty() ? own_at(x, y) : other.at(x, y) * albedo_at(x, y); }
};

/// Light too bright for squares in float32 stays as it is.
bool is_too_bright(float value);

/// Writes the radiance of each pixel p: own(p), or if it sees several surfaces
///     share(p) own(p) + sum over the pixels n around of share(n) own(n) + share(other) other(p),
/// shares by coverage. Values that are too bright are left.
void resolve(const EdgePlane& light, const Coverage& coverage, int width, int height, std::vector<float>& values);

}  // namespace tempolux
