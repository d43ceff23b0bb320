// lib/image/pixel_surfaces.h -- the rule that decides by depth, normal and object whether two pixels show one smooth
// surface. lib/filter/surface_weight.h applies it.
#pragma once

#include <algorithm>
#include <cmath>

namespace tempolux {

/// Depth counts as w = 1/Z; w = 0 means no surface. In perspective, w of a plane is linear in pixels, so a pixel's w
/// and slopes predict the w of its neighbours. A pixel and the pixel at offset (dx, dy) (right, down) show one surface
/// if they have the same object and normals whose cosine is at least kSameNormal, and if the other pixel's w differs
/// from the predicted w by at most kSameDepth w plus the predicted change over the offset. So the slope of a curved
/// surface may double.
struct PixelSurfaces {
  /// Cosine of the largest angle (26 degrees) between normals of one surface (docs/methods/formulas.md).
  static constexpr float kSameNormal = 0.9f;
  /// Relative difference of w that is always allowed (docs/methods/formulas.md).
  static constexpr float kSameDepth = 1e-3f;

  /// w of a depth; 0 if there is no surface.
  static float inverse_depth(float z) {
    constexpr float kNearest = 1e-18f;  // m; keeps the square of 1/Z finite
    return z > 0 && z < 3e38f ? 1 / std::max(z, kNearest) : 0;
  }
  /// A slope of w from the differences to both neighbours: the difference closer to 0; if one is unknown, the other; 0
  /// if both are.
  static float smaller(float before, bool before_known, float after, bool after_known) {
    if (!before_known || !after_known) return before_known ? before : after_known ? after : 0;
    return std::abs(before) < std::abs(after) ? before : after;
  }
};

}  // namespace tempolux
