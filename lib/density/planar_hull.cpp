#include "lib/density/planar_hull.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

constexpr double kSteps = 65536;
constexpr std::size_t kKept = 64;  ///< new points after which the hull is computed again, besides the hull's number

std::int32_t step(double t) { return std::int32_t(std::clamp(std::floor(t * kSteps), 0.0, kSteps - 1)); }

/// Twice the area of the triangle a, b, c; positive if its corners are counter-clockwise.
std::int64_t turn(const std::array<std::int32_t, 2>& a, const std::array<std::int32_t, 2>& b,
                  const std::array<std::int32_t, 2>& c) {
  return std::int64_t(b[0] - a[0]) * (c[1] - a[1]) - std::int64_t(b[1] - a[1]) * (c[0] - a[0]);
}

}  // namespace

/// Andrew's monotone chain: the lower hull from left to right, then the upper hull back.
std::vector<PlanarHull::Corner> PlanarHull::corners() const {
  std::vector<Corner> sorted = points_;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() < 3) return sorted;
  std::vector<Corner> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Corner& point : sorted) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();  // it is the first corner of the other side
    std::reverse(sorted.begin(), sorted.end());
  }
  return hull;
}

void PlanarHull::add(double u, double v) {
  ++count_;
  points_.push_back({step(u), step(v)});
  if (points_.size() < room_) return;
  points_ = corners();
  room_ = 2 * points_.size() + kKept;
}

double PlanarHull::area() const {
  const std::vector<Corner> hull = corners();
  std::int64_t twice = 0;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i) twice += turn(hull[0], hull[i], hull[i + 1]);
  if (twice == 0) return 0;
  const double inside = double(count_) + 1 - double(std::min<std::uint64_t>(hull.size(), count_));
  return std::min(1.0, double(twice) / (2 * kSteps * kSteps) * (double(count_) + 1) / inside);
}

}  // namespace tempolux
