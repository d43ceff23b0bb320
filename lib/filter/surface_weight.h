// lib/filter/surface_weight.h -- decides for rows of pixels whether a pixel may take light from another one.
#pragma once

#include <cmath>
#include <cstddef>

#include "lib/filter/lane.h"
#include "lib/filter/surfaces.h"

namespace tempolux {

/// Compares a row of pixels with the row of pixels (dx, dy) away: 1 if both are on one surface (PixelSurfaces::same),
/// else 0.
class SurfaceRow {
 public:
  SurfaceRow(const Surfaces& of, int y, int dx, int dy)
      : object_(of.object.row(y)),
        other_object_(of.object.row(y + dy) + dx),
        w_(of.w.row(y)),
        other_w_(of.w.row(y + dy) + dx),
        w_right_(of.w_right.row(y)),
        w_down_(of.w_down.row(y)),
        nx_(of.nx.row(y)),
        ny_(of.ny.row(y)),
        nz_(of.nz.row(y)),
        other_nx_(of.nx.row(y + dy) + dx),
        other_ny_(of.ny.row(y + dy) + dx),
        other_nz_(of.nz.row(y + dy) + dx),
        dx_(float(dx)),
        dy_(float(dy)) {}

  float surface(std::size_t i) const {
    const float facing = nx_[i] * other_nx_[i] + ny_[i] * other_ny_[i] + nz_[i] * other_nz_[i];
    const float length2 = nx_[i] * nx_[i] + ny_[i] * ny_[i] + nz_[i] * nz_[i];
    const float right = w_right_[i] * dx_, down = w_down_[i] * dy_;
    const float off = std::abs(other_w_[i] - w_[i] - right - down);
    const float allowed = PixelSurfaces::kSameDepth * w_[i] + std::abs(right) + std::abs(down);
    // Products of conditions instead of &&: all lanes of a vector compute the same.
    return float(object_[i] == other_object_[i]) * float(facing >= PixelSurfaces::kSameNormal * length2) *
           float(off <= allowed);
  }

 private:
  const std::uint32_t *object_, *other_object_;
  const float *w_, *other_w_, *w_right_, *w_down_, *nx_, *ny_, *nz_, *other_nx_, *other_ny_, *other_nz_;
  float dx_, dy_;
};

/// The same for eight pixels (x + i, y) and those (dx, dy) away, for one dy. The pixels' own values are loaded once.
class SurfaceEight {
 public:
  SurfaceEight(const Surfaces& frame, int y, int dy, std::size_t x)
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

  /// 1 if both are on one surface, else 0.
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
