// lib/trace/mover_watch.h -- finds the photon rays that movers can touch, and in which frames.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/scene/static_scene.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Boxes of all movers, for intervals of a segment's frames. If a ray misses all boxes of an interval, no mover can
/// block it in these frames, so a photon takes this ray with or without movers.
class MoverWatch {
 public:
  /// 1 to 64 intervals; the boxes of an interval hold all movers in any of its frames.
  explicit MoverWatch(std::vector<MovingBoxes> intervals);

  /// The value of touching() for a ray that meets a box in every interval: one bit per interval.
  std::uint64_t all() const { return ~std::uint64_t(0) >> (64 - intervals_.size()); }
  /// Bit i is set if the ray meets a box of interval i before `t` times its direction; t may be infinite.
  std::uint64_t touching(const Ray& ray, float t) const;
  /// False only if every segment from `from` to a place in `target` misses the boxes of all intervals.
  bool between(Vec3 from, const Box3& target) const;

 private:
  std::vector<MovingBoxes> intervals_;
  Box3 whole_;
};

}  // namespace tempolux
