#include "lib/temporal/swept_boxes.h"

#include <algorithm>
#include <cmath>

#include "lib/core/sampling.h"

namespace tempolux {
namespace {

constexpr float kMargin = 0x1p-18f;  ///< rounding of rays and boxes, as a share of the largest coordinate
constexpr float kAngle = 1e-3f;      ///< radians: rounding of angles

void widen(Box3& box) {
  const float margin = kMargin * max_component(max(abs(box.lower), abs(box.upper)));
  box.lower = box.lower - Vec3{margin, margin, margin};
  box.upper = box.upper + Vec3{margin, margin, margin};
}

}  // namespace

std::vector<Box3> swept_boxes(const SceneFrame& before, const SceneFrame& now) {
  std::vector<Box3> boxes;
  for (std::size_t s = now.static_count; s < now.surfaces.size(); ++s) {
    const Surface &a = before.surfaces[s], &b = now.surfaces[s];
    Box3 box;
    bool differs = false;
    for (std::uint32_t v = 0; v < b.primitive->positions.size(); ++v) {
      const Vec3 old = a.position(v), place = b.position(v);
      differs |= !(old == place);
      box.add(old);
      box.add(place);
    }
    if (!differs || box.empty()) continue;
    widen(box);
    boxes.push_back(box);
  }
  return boxes;
}

bool meets(const Ray& ray, float t, const Box3& box) {
  float first = 0, last = t * (1 + 0x1p-20f);
  for (int axis = 0; axis < 3; ++axis) {
    // A ray in the plane of a face gives 0 x infinity = NaN. std::min and std::max ignore NaN as their second argument.
    const float inverse = 1 / ray.direction[axis];
    const float a = (box.lower[axis] - ray.origin[axis]) * inverse, b = (box.upper[axis] - ray.origin[axis]) * inverse;
    first = std::max(first, inverse < 0 ? b : a);
    last = std::min(last, inverse < 0 ? a : b);
  }
  return first <= last;
}

CellsTowards::CellsTowards(Vec3 position, const Frame& frame, const Box3& box, int rings, int sectors)
    : sectors_(sectors) {
  const Vec3 to = box.centre() - position;
  const Vec3 local{dot(to, frame.tangent), dot(to, frame.bitangent), dot(to, frame.normal)};
  const float distance = length(local), radius = 0.5f * box.diagonal();
  first_ring_ = 0;
  last_ring_ = rings - 1;
  sector_count_ = sectors;
  if (!(distance > radius)) return;
  const float half = std::asin(radius / distance) + kAngle;
  const float tilt = std::acos(std::clamp(local.z / distance, -1.0f, 1.0f));
  if (tilt - half >= kPi / 2) {
    last_ring_ = -1;
    return;
  }
  const auto ring_at = [&](float angle) {
    const float s = std::sin(std::min(angle, kPi / 2));
    return std::min(rings - 1, int(s * s * float(rings)));
  };
  last_ring_ = ring_at(tilt + half);
  if (tilt <= half) return;  // the cone holds the normal, so all azimuths are possible
  first_ring_ = ring_at(tilt - half);
  const float spread = std::asin(std::min(1.0f, std::sin(std::min(half, kPi / 2)) / std::sin(tilt))) + kAngle;
  if (tilt + half >= kPi / 2 && !(spread < kPi / 2)) return;
  const float azimuth = std::atan2(local.y, local.x), per_radian = float(sectors) / (2 * kPi);
  const int first = int(std::floor((azimuth - spread) * per_radian)),
            last = int(std::floor((azimuth + spread) * per_radian));
  sector_count_ = std::min(sectors, last - first + 1);
  first_sector_ = (first % sectors + sectors) % sectors;
}

}  // namespace tempolux
