#include "lib/points/point_region.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/parallel_each.h"

namespace tempolux {
namespace {

constexpr double kHeld = 0.95;   ///< docs/methods/aim.md, "Irradiance points"
constexpr double kPiece = 0.25;  ///< longest edge of a piece that crosses a sphere's outline, over the sphere's radius

/// Divides a triangle into four pieces at the middles of its edges, and these pieces again, until a piece crosses no
/// sphere's outline or is small.
class Splitter {
 public:
  Splitter(std::span<const AimSphere> spheres, std::uint32_t triangle, std::array<Vec3d, 3> corners,
           std::vector<TrianglePiece>& pieces)
      : spheres_(spheres), triangle_(triangle), corners_(corners), pieces_(pieces) {}

  void split(const std::array<Vec2, 3>& at) {
    const std::array<Vec3d, 3> p{place(at[0]), place(at[1]), place(at[2])};
    const Vec3d middle = (p[0] + p[1] + p[2]) / 3.0;
    const double reach = std::max({length(p[0] - middle), length(p[1] - middle), length(p[2] - middle)});
    const double longest = std::max({length(p[1] - p[0]), length(p[2] - p[1]), length(p[0] - p[2])});
    std::uint32_t within = 0;
    bool split_it = false;
    for (std::size_t k = 0; k < spheres_.size(); ++k) {
      const AimSphere& sphere = spheres_[k];
      const double away = length(middle - sphere.centre);
      if (away > sphere.radius + reach) continue;
      if (away <= sphere.radius) within |= 1u << k;
      const bool whole =
          std::ranges::all_of(p, [&](Vec3d corner) { return length(corner - sphere.centre) <= sphere.radius; });
      split_it = split_it || (!whole && longest > kPiece * sphere.radius);
    }
    const std::array<Vec2, 3> half{between(at[1], at[2]), between(at[2], at[0]), between(at[0], at[1])};
    // Barycentric weights are floats: a piece smaller than 2^-20 of its triangle is not divided.
    if (split_it && std::max(std::abs(at[1].x - at[0].x), std::abs(at[1].y - at[0].y)) > 0x1p-20f) {
      split({at[0], half[2], half[1]});
      split({half[2], at[1], half[0]});
      split({half[1], half[0], at[2]});
      split(half);
    } else if (within) {
      pieces_.push_back({triangle_, {at[0], at[1], at[2]}, 0.5 * length(cross(p[1] - p[0], p[2] - p[0])), within});
    }
  }

 private:
  Vec3d place(Vec2 w) const {
    return corners_[0] * (1 - double(w.x) - double(w.y)) + corners_[1] * double(w.x) + corners_[2] * double(w.y);
  }
  static Vec2 between(Vec2 a, Vec2 b) { return {(a.x + b.x) * 0.5f, (a.y + b.y) * 0.5f}; }

  std::span<const AimSphere> spheres_;
  std::uint32_t triangle_;
  std::array<Vec3d, 3> corners_;
  std::vector<TrianglePiece>& pieces_;
};

}  // namespace

std::vector<TrianglePiece> pieces_in(const Surface& surface, std::span<const AimSphere> spheres) {
  const auto& triangles = surface.primitive->triangles;
  return parallel_found<TrianglePiece>(triangles.size(), 4096, [&](std::size_t i, std::vector<TrianglePiece>& found) {
    const auto& t = triangles[i];
    Splitter(spheres, std::uint32_t(i),
             {Vec3d(surface.position(t[0])), Vec3d(surface.position(t[1])), Vec3d(surface.position(t[2]))}, found)
        .split({Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}});
  });
}

std::vector<AimSphere> spheres_with_points(std::span<const AimSphere> spheres, std::span<const double> areas) {
  std::vector<std::size_t> order;
  double whole = 0;
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    if (!(areas[k] > 0)) continue;
    order.push_back(k);
    whole += spheres[k].weight;
  }
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t k) { return spheres[k].weight / areas[k]; });
  std::vector<AimSphere> taken;
  double held = 0;
  for (const std::size_t k : order) {
    if (held >= kHeld * whole) break;
    held += spheres[k].weight;
    taken.push_back(spheres[k]);
  }
  return taken;
}

}  // namespace tempolux
