// lib/trace/mover_watch.h -- which ways of photons lead past what moves, and when.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/scene/standing.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Boxes of what moves in the intervals of a segment. A way that meets none of an interval's boxes is met by nothing
/// that moves in it, so that the photon takes it whether movers are there or not.
class MoverWatch {
 public:
  /// By interval, 1 to 64; boxes hold all that moves in any frame of the interval.
  explicit MoverWatch(std::vector<MovingBoxes> intervals);

  std::size_t interval_count() const { return intervals_.size(); }
  std::uint64_t all() const { return ~std::uint64_t(0) >> (64 - intervals_.size()); }
  /// Bit i: the ray, up to `t` of its lengths (infinity: it left the scene), meets a box of interval i.
  std::uint64_t touching(const Ray& ray, float t) const;
  /// False only if no segment from `from` to a place in `target` comes near a box of any interval.
  bool between(Vec3 from, const Box3& target) const;

 private:
  std::vector<MovingBoxes> intervals_;
  Box3 whole_;
};

}  // namespace tempolux
