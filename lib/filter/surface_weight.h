// lib/filter/surface_weight.h -- decides for eight pixels at once which pixels are on their surfaces.
#pragma once

#include <cstddef>

#include "lib/filter/lane.h"
#include "lib/filter/surfaces.h"

namespace tempolux {

/// Compares the eight pixels (x + i, y), i from 0 to 7, with the pixels (dx, dy) away from them, for one dy and any dx:
/// the rule of PixelSurfaces. The values of the eight pixels are loaded once. All pixels lie in the picture or its
/// margin.
class SurfaceEight {
 public:
  SurfaceEight(const Surfaces& frame, int y, int dy, std::ptrdiff_t x)
      : object_(load8(frame.object.row(y) + x)),
        nx_(load8(frame.nx.row(y) + x)),
        ny_(load8(frame.ny.row(y) + x)),
        nz_(load8(frame.nz.row(y) + x)),
        facing_(PixelSurfaces::kSameNormal * (nx_ * nx_ + ny_ * ny_ + nz_ * nz_)),
        w_right_(load8(frame.w_right.row(y) + x)),
        other_object_(frame.object.row(y + dy) + x),
        other_w_(frame.w.row(y + dy) + x),
        other_nx_(frame.nx.row(y + dy) + x),
        other_ny_(frame.ny.row(y + dy) + x),
        other_nz_(frame.nz.row(y + dy) + x) {
    const Float8 w = load8(frame.w.row(y) + x), down = load8(frame.w_down.row(y) + x) * float(dy);
    expected_ = w + down;
    allowed_ = PixelSurfaces::kSameDepth * w + abs8(down);
  }

  /// By pixel: 1 if it and the pixel (dx, dy) away are on one surface, else 0.
  Float8 surface(int dx) const {
    const Float8 facing =
        multiply_add(nx_, load8(other_nx_ + dx), multiply_add(ny_, load8(other_ny_ + dx), nz_ * load8(other_nz_ + dx)));
    const Float8 right = w_right_ * float(dx), off = abs8(load8(other_w_ + dx) - expected_ - right);
    const Int8 same = (object_ == load8(other_object_ + dx)) & (facing >= facing_) & (off <= allowed_ + abs8(right));
    return where(same, all8(1));
  }

 private:
  Int8 object_;
  Float8 nx_, ny_, nz_, facing_, w_right_, expected_, allowed_;
  const std::uint32_t* other_object_;
  const float *other_w_, *other_nx_, *other_ny_, *other_nz_;
};

}  // namespace tempolux
