#include "lib/light/convex_shell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

namespace tempolux {
namespace {

constexpr std::size_t kMostTriangles = 1024;   // the check of convexity is quadratic
constexpr double kFlat = 1e-5;                 // of the diagonal

bool before(Vec3 a, Vec3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

/// Is each side of a triangle run along by exactly one other, the other way? Corners at one place count as one.
bool is_closed(const std::vector<std::array<Vec3, 3>>& triangles) {
  using Edge = std::pair<Vec3, Vec3>;
  std::vector<Edge> along, back;
  for (const auto& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      along.emplace_back(t[i], t[(i + 1) % 3]);
      back.emplace_back(t[(i + 1) % 3], t[i]);
    }
  const auto less = [](const Edge& a, const Edge& b) { return a.first == b.first ? before(a.second, b.second) : before(a.first, b.first); };
  std::sort(along.begin(), along.end(), less);
  std::sort(back.begin(), back.end(), less);
  return along == back && std::adjacent_find(along.begin(), along.end()) == along.end();
}

}  // namespace

std::optional<Ball> convex_shell(const Surface& surface) {
  const auto& indices = surface.primitive->triangles;
  if (indices.size() < 4 || indices.size() > kMostTriangles) return std::nullopt;
  std::vector<std::array<Vec3, 3>> triangles;
  Box3 box;
  for (const auto& corner : indices) {
    triangles.push_back({surface.position(corner[0]), surface.position(corner[1]), surface.position(corner[2])});
    for (const Vec3 p : triangles.back()) box.add(p);
  }
  if (!is_closed(triangles)) return std::nullopt;
  const double flat = kFlat * double(box.diagonal());
  for (const auto& t : triangles) {
    const Vec3d a(t[0]), across = cross(Vec3d(t[1]) - a, Vec3d(t[2]) - a), outwards = normalize(surface.flipped ? -across : across);
    for (const auto& other : triangles)
      for (const Vec3 p : other)
        if (dot(Vec3d(p) - a, outwards) > flat) return std::nullopt;
  }
  Ball ball{box.centre(), 0};
  for (const auto& t : triangles)
    for (const Vec3 p : t) ball.radius = std::max(ball.radius, length(p - ball.centre) * (1 + float(kFlat)));
  return ball;
}

}  // namespace tempolux
