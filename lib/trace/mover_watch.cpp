#include "lib/trace/mover_watch.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

/// A ray, prepared for tests against boxes.
struct Slabs {
  Vec3 below, above, inverse;  ///< the ray's origin, moved down and up by a rounding error
  float leave;

  /// Rays are traced relative to their origin, with an error of 2^-24 of the distance. Boxes exceed their content by
  /// 2^-18 of their largest coordinate; for rays from farther away they are enlarged by another 2^-21 of the origin's
  /// coordinate. `leave` exceeds the ray's length by a few roundings.
  Slabs(const Ray& ray, float t)
      : inverse{1 / ray.direction.x, 1 / ray.direction.y, 1 / ray.direction.z}, leave(t * (1 + 0x1p-20f)) {
    const float far = 0x1p-21f * max_component(abs(ray.origin));
    below = ray.origin - Vec3{far, far, far};
    above = ray.origin + Vec3{far, far, far};
  }
  /// False only if the ray surely misses the box.
  bool meet(const Box3& box) const { return !box.empty() && meets_slabs(box, below, above, inverse, 0, leave); }
  /// False only if the ray surely misses the boxes of a surface.
  bool meet(const MovingBoxes& boxes, std::size_t surface) const {
    if (!meet(boxes.surfaces[surface])) return false;
    const std::span<const Box3> pieces = boxes.pieces_of(surface);
    return pieces.empty() || std::ranges::any_of(pieces, [this](const Box3& box) { return meet(box); });
  }
};

/// True if a segment from `from` to a place in `target` can meet `box`. At the share t of its length, the segment's
/// coordinate lies between from + t (target.lower - from) and from + t (target.upper - from). The function finds the t
/// at which this interval meets the box, for all axes.
bool shaft_meets(Vec3 from, const Box3& target, const Box3& box) {
  if (box.empty()) return false;
  float first = 0, last = 1;
  const auto at_least = [&](float slope, float value) {  // keeps the t with slope t >= value
    if (slope > 0) first = std::max(first, value / slope);
    else if (slope < 0) last = std::min(last, value / slope);
    else if (value > 0) last = -1;
  };
  for (int axis = 0; axis < 3; ++axis) {
    at_least(target.upper[axis] - from[axis], box.lower[axis] - from[axis]);
    at_least(from[axis] - target.lower[axis], from[axis] - box.upper[axis]);
  }
  return first <= last * (1 + 0x1p-18f);
}

}  // namespace

bool MoverWatch::between(Vec3 from, const Box3& target) const {
  if (!shaft_meets(from, target, whole_)) return false;
  return std::ranges::any_of(intervals_, [&](const MovingBoxes& boxes) {
    return std::ranges::any_of(boxes.surfaces, [&](const Box3& box) { return shaft_meets(from, target, box); });
  });
}

MoverWatch::MoverWatch(std::vector<MovingBoxes> intervals) : intervals_(std::move(intervals)) {
  for (const MovingBoxes& boxes : intervals_) whole_.add(boxes.all);
}

std::uint64_t MoverWatch::touching(const Ray& ray, float t) const {
  const Slabs slabs(ray, t);
  if (!slabs.meet(whole_)) return 0;
  std::uint64_t found = 0;
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    const MovingBoxes& boxes = intervals_[i];
    if (!slabs.meet(boxes.all)) continue;
    for (std::size_t surface = 0; surface < boxes.surfaces.size(); ++surface)
      if (slabs.meet(boxes, surface)) {
        found |= std::uint64_t(1) << i;
        break;
      }
  }
  return found;
}

}  // namespace tempolux
