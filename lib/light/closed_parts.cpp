#include "lib/light/closed_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

namespace tempolux {
namespace {

/// Corners closer than about this share of the surface's size are at one place: exporters close a sphere at 2 pi, which
/// is not 0 after rounding.
constexpr float kSamePlace = 0x1p-20f;

/// By vertex, the number of the first vertex at the same place.
std::vector<std::uint32_t> first_at_place(const std::vector<Vec3>& positions) {
  Box3 box;
  for (const Vec3 p : positions) box.add(p);
  const float step = std::max(max_component(box.upper - box.lower) * kSamePlace, 1e-30f);
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto place = [&](std::uint32_t v) {
    const Vec3 p = (positions[v] - box.lower) / step;
    return std::tuple(std::round(p.x), std::round(p.y), std::round(p.z));
  };
  std::ranges::sort(order, {}, [&](std::uint32_t v) { return std::tuple(place(v), v); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && place(order[i]) == place(order[i - 1]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

/// Groups of vertices that are joined step by step.
struct Groups {
  std::vector<std::uint32_t> parent;
  std::uint32_t of(std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent[of(a)] = of(b); }
};

/// An edge from `low` to the vertex `high`, or back.
struct Edge {
  std::uint32_t low, high;
  bool back;
  bool operator<(const Edge& o) const { return std::tie(low, high, back) < std::tie(o.low, o.high, o.back); }
  bool same_place(const Edge& o) const { return low == o.low && high == o.high; }
};

bool is_opaque(const Material& m) { return m.alpha_mode == Material::Alpha::opaque && m.transmission == 0 && !m.unlit; }

}  // namespace

std::vector<Box3> closed_parts(const SceneFrame& frame, std::uint32_t surface) {
  const Surface& s = frame.surfaces[surface];
  const auto& triangles = s.primitive->triangles;
  std::vector<Box3> boxes(triangles.size());
  if (!is_opaque(frame.materials[s.material])) return boxes;
  std::vector<Vec3> positions(s.primitive->positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) positions[v] = s.position(v);
  const std::vector<std::uint32_t> place = first_at_place(positions);
  Groups groups{place};
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (const auto& corners : triangles) {
    const std::array<std::uint32_t, 3> at{place[corners[0]], place[corners[1]], place[corners[2]]};
    if (at[0] == at[1] || at[1] == at[2] || at[2] == at[0]) continue;  // poles of spheres have triangles without area
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = at[i], b = at[(i + 1) % 3];
      groups.join(a, b);
      edges.push_back({std::min(a, b), std::max(a, b), a > b});
    }
  }
  std::ranges::sort(edges, std::less());
  std::vector<std::uint8_t> open(positions.size());  // by group
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t last = i + 1;
    while (last < edges.size() && edges[last].same_place(edges[i])) ++last;
    if (last - i != 2 || edges[i].back == edges[i + 1].back) open[groups.of(edges[i].low)] = 1;
    i = last;
  }
  std::vector<Box3> box(positions.size());
  std::vector<double> volume(positions.size());  // six times, in m^3
  for (const auto& corners : triangles) {
    const std::uint32_t group = groups.of(place[corners[0]]);
    const Vec3d origin(positions[group]);
    std::array<Vec3d, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      box[group].add(positions[corners[i]]);
      p[i] = Vec3d(positions[corners[i]]) - origin;
    }
    volume[group] += dot(p[0], cross(p[1], p[2])) * (s.flipped ? -1 : 1);
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t group = groups.of(place[triangles[t][0]]);
    if (!open[group] && volume[group] > 0) boxes[t] = box[group];
  }
  return boxes;
}

}  // namespace tempolux
