// lib/trace/mover_watch.h -- finds the photon rays that movers can touch, and in which frames.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/scene/static_scene.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Boxes of all movers, by interval of frames of a segment. If a ray misses all boxes of an interval, no mover can
/// block it in these frames: the photon takes this ray with or without movers.
class MoverWatch {
 public:
  /// 1 to 64 intervals; the boxes of an interval hold all movers in any of its frames.
  explicit MoverWatch(std::vector<MovingBoxes> intervals);

  std::size_t interval_count() const { return intervals_.size(); }
  std::uint64_t all() const { return ~std::uint64_t(0) >> (64 - intervals_.size()); }
  /// Bit i is set if the ray, up to `t` times its direction (infinity: it left the scene), meets a box of interval i.
  std::uint64_t touching(const Ray& ray, float t) const;
  /// False only if every segment from `from` to a place in `target` misses the boxes of all intervals.
  bool between(Vec3 from, const Box3& target) const;

 private:
  std::vector<MovingBoxes> intervals_;
  Box3 whole_;
};

}  // namespace tempolux
