// lib/filter/resolve.h -- pixels at edges put together from the surfaces they see.
#pragma once

#include <vector>

#include "lib/filter/coverage.h"
#include "lib/filter/light_frame.h"

namespace tempolux {

/// One channel of the light of surfaces: radiance is light times albedo (an empty plane: 1).
struct EdgePlane {
  const Plane& own;     ///< by pixel: of its own surface
  const Plane& other;   ///< of what no centre around shows; an empty plane: black
  const Plane& albedo;

  float albedo_at(int x, int y) const { return albedo.empty() ? 1 : albedo.at(x, y); }
  float own_at(int x, int y) const { return own.at(x, y) * albedo_at(x, y); }
  float other_at(int x, int y) const { return other.empty() ? 0 : other.at(x, y) * albedo_at(x, y); }
};

/// Light too bright for squares in float32 stays as it is.
bool is_too_bright(float value);

/// Writes the radiance of each pixel p: own(p), or if it sees several surfaces
///     share(p) own(p) + sum over the pixels n around of share(n) own(n) + share(other) other(p),
/// shares by coverage. Values that are too bright are left.
void resolve(const EdgePlane& light, const Coverage& coverage, int width, int height, std::vector<float>& values);

/// The same, in place, for what passes the filter: emission, specular and A, as far as the image has them; LightFrame::inside pixels keep their
/// bits. At edges a sample may be of any surface, one that covers less of the pixel than coverage counts among them: what each surface
/// has is the mean over inside pixels on it nearby (5 x 5), where there are none the pixel's own value. What coverage.other counts is taken to
/// have as much as the pixel's own surface. A pixel's own value, the mean of n samples (channel samples; without it n = 1), counts by
/// (n - 1)^(5/3) beside 16^(5/3) of what is put together by the 16 rays of coverage: both err by the places they know the pixel at, stratified.
void resolve_passing(const LightFrame& frame, const Coverage& coverage, Image& image);

}  // namespace tempolux
