// lib/temporal/swept_boxes.h -- boxes around everything that has moved between two frames.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/gather/gather_directions.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// One box for each surface whose vertices differ between two frames of a segment [m, scene space]: it encloses the
/// surface at both frames, and is slightly larger because of rounding.
std::vector<Box3> swept_boxes(const SceneFrame& before, const SceneFrame& now);

/// True if the ray meets the box between its origin and origin + t direction; t may be infinite. Also true if rounding
/// leaves the answer open.
bool meets(const Ray& ray, float t, const Box3& box);

/// Finds the cells of a hemisphere through which a box can be visible: all cells that the cone around the box's
/// bounding sphere can meet.
class CellsTowards {
 public:
  CellsTowards(Vec3 position, const Frame& frame, const Box3& box, int rings, int sectors);

  /// Calls body(cell) for each of these cells.
  template <class Body>
  void for_each(const Body& body) const {
    for (int j = first_ring_; j <= last_ring_; ++j)
      for (int i = 0; i < sector_count_; ++i) body(std::uint32_t(j * sectors_ + (first_sector_ + i) % sectors_));
  }

 private:
  int sectors_;
  int first_ring_ = 0, last_ring_ = -1, first_sector_ = 0, sector_count_ = 0;
};

}  // namespace tempolux
