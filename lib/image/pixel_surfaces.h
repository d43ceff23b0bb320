// lib/image/pixel_surfaces.h -- do two pixels of a frame see one smooth surface? By their depth, normal and object.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// What each pixel's centre sees, from the channels Z, N.* and id.object. A channel that is absent agrees everywhere.
///
/// Depth is kept as w = 1/Z: on a plane seen in perspective it is linear in pixels, so that a pixel's w and its slopes
/// say what its neighbours' should be. Nothing seen: w = 0.
class PixelSurfaces {
 public:
  /// Cosine of the largest angle (26 degrees) between normals of one surface (docs/methods/formulas.md).
  static constexpr float kSameNormal = 0.9f;
  /// Relative error of depth that is always allowed (docs/methods/formulas.md).
  static constexpr float kSameDepth = 1e-3f;

  explicit PixelSurfaces(const Image& image);

  /// w of a depth; 0 where nothing is seen.
  static float inverse_depth(float z) {
    constexpr float kNearest = 1e-18f;  // m; 1/Z squared stays finite
    return z > 0 && z < 3e38f ? 1 / std::max(z, kNearest) : 0;
  }
  /// A slope of w from the differences to the pixel before and to the one after: the one nearer to 0; of one that is
  /// not known the other.
  static float smaller(float before, bool before_known, float after, bool after_known) {
    if (!before_known || !after_known) return before_known ? before : after_known ? after : 0;
    return std::abs(before) < std::abs(after) ? before : after;
  }

  int width() const { return width_; }
  int height() const { return height_; }
  /// Is the pixel (dx, dy) away from `pixel` (right, down; it lies in the picture) on the surface that `pixel` is on?
  /// Same object, normals within kSameNormal, and w off the plane through `pixel` by at most kSameDepth of it plus what
  /// the plane itself changes: a curved surface may double its slope.
  bool same(std::size_t pixel, int dx, int dy) const;
  /// 1 for each pixel that is not on the same surface as all of its eight neighbours, both ways asked.
  std::vector<std::uint8_t> edges() const;

  // One entry a pixel, for loops that test many at once. Objects are bits of id.object; normals are 0, 0, 0 where
  // nothing is seen or known.
  std::vector<std::uint32_t> object;
  std::vector<float> w, w_right, w_down;  ///< 1/m; its change per pixel: the smaller of the two one-sided differences
  std::vector<float> nx, ny, nz;

 private:
  int width_, height_;
};

}  // namespace tempolux
