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

/// For each vertex, the number of the first vertex at the same place.
std::vector<std::uint32_t> first_at_place(const std::vector<Vec3>& positions) {
  Box3 box;
  for (const Vec3 p : positions) box.add(p);
  const float step = std::max(max_component(box.upper - box.lower) * kSamePlace, 1e-30f);
  struct Place {
    float x, y, z;  // in steps
    std::uint32_t vertex;
    auto operator<=>(const Place&) const = default;
    bool same(const Place& o) const { return x == o.x && y == o.y && z == o.z; }
  };
  std::vector<Place> places;
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    const Vec3 p = (positions[v] - box.lower) / step;
    places.push_back({std::round(p.x), std::round(p.y), std::round(p.z), v});
  }
  std::ranges::sort(places, std::less());
  std::vector<std::uint32_t> first(positions.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    first[places[i].vertex] = i > 0 && places[i].same(places[i - 1]) ? first[places[i - 1].vertex] : places[i].vertex;
  return first;
}

/// Disjoint sets of triangles; a set is named by one of its triangles.
struct Groups {
  std::vector<std::uint32_t> parent;
  explicit Groups(std::size_t count) : parent(count) { std::iota(parent.begin(), parent.end(), 0u); }
  std::uint32_t of(std::uint32_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent[of(a)] = of(b); }
};

/// An edge of a triangle from the vertex `low` to the vertex `high`; `back`: from high to low.
struct Edge {
  std::uint32_t low, high, triangle;
  bool back;
  bool operator<(const Edge& o) const { return std::tie(low, high, back) < std::tie(o.low, o.high, o.back); }
  bool joins_same(const Edge& o) const { return low == o.low && high == o.high; }
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
  Groups groups(triangles.size());
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::array<std::uint32_t, 3> at{place[triangles[t][0]], place[triangles[t][1]], place[triangles[t][2]]};
    if (at[0] == at[1] || at[1] == at[2] || at[2] == at[0]) continue;  // poles of spheres have triangles without area
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = at[i], b = at[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, a > b});
    }
  }
  std::ranges::sort(edges, std::less());
  std::vector<std::uint32_t> torn;  // triangles at edges that do not belong to two triangles of opposite winding
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t last = i + 1;
    for (; last < edges.size() && edges[last].joins_same(edges[i]); ++last)
      groups.join(edges[i].triangle, edges[last].triangle);
    if (last - i != 2 || edges[i].back == edges[i + 1].back) torn.push_back(edges[i].triangle);
    i = last;
  }
  std::vector<std::uint8_t> open(triangles.size());  // by group, like `box` and `volume`
  for (const std::uint32_t t : torn) open[groups.of(t)] = 1;
  std::vector<Box3> box(triangles.size());
  std::vector<double> volume(triangles.size());  // six times the signed volume, m^3
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t group = groups.of(t);
    const Vec3d origin(positions[triangles[group][0]]);
    std::array<Vec3d, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      box[group].add(positions[triangles[t][i]]);
      p[i] = Vec3d(positions[triangles[t][i]]) - origin;
    }
    volume[group] += dot(p[0], cross(p[1], p[2])) * (s.flipped ? -1 : 1);
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t group = groups.of(t);
    if (!open[group] && volume[group] > 0) boxes[t] = box[group];
  }
  return boxes;
}

}  // namespace tempolux
