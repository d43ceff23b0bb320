// lib/image/pixel_surfaces.h -- decides by depth, normal and object whether two pixels show one smooth surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// The surface at each pixel's centre, from the channels Z, N.* and id.object. A missing channel does not distinguish
/// surfaces.
///
/// Depth is stored as w = 1/Z; w = 0 means no surface. In perspective, w of a plane is linear in pixels, so a pixel's w
/// and slopes predict the w of its neighbours.
class PixelSurfaces {
 public:
  /// Cosine of the largest angle (26 degrees) between normals of one surface (docs/methods/formulas.md).
  static constexpr float kSameNormal = 0.9f;
  /// Relative difference of w that is always allowed (docs/methods/formulas.md).
  static constexpr float kSameDepth = 1e-3f;

  explicit PixelSurfaces(const Image& image);

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

  int width() const { return width_; }
  int height() const { return height_; }
  /// True if `pixel` and the pixel at offset (dx, dy) (right, down; inside the picture) show one surface. They must
  /// have the same object, and normals whose cosine is at least kSameNormal. The other pixel's w may differ from the w
  /// that `pixel` predicts by kSameDepth w plus the predicted change over the offset, so the slope of a curved surface
  /// may double.
  bool same(std::size_t pixel, int dx, int dy) const;

  // One entry per pixel; public, for loops that test many pixels at once.
  std::vector<std::uint32_t> object;      ///< id.object
  std::vector<float> w, w_right, w_down;  ///< 1/m; slopes of w per pixel to the right and downwards (smaller())
  std::vector<float> nx, ny, nz;          ///< unit normal; 0, 0, 0 if unknown or without a surface

 private:
  int width_, height_;
};

}  // namespace tempolux
