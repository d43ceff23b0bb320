#include "lib/trace/plates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "lib/core/sobol.h"
#include "lib/trace/trace.h"

namespace tempolux {
namespace {

constexpr double kLargestTilt = 5e-4;    ///< rad: mean deviation of a face's normals (the head of find_plates)
constexpr double kLargestRim = 0.05;     ///< share of the rim in the area: straight rays are wrong at the rim alone
constexpr double kSameThickness = 0.05;  ///< unevenness of a face over the thickness, on which only absorption depends
constexpr double kShadingTilt = 0.01;    ///< of shading normals; normals of 8 bits err by half of it
constexpr double kFaceCosine = 0.99;     ///< triangles at this cosine belong to faces, others to the rim

/// Index of the first vertex at the same place, for each vertex. Exporters split the vertices of sharp edges.
std::vector<std::uint32_t> welded(const Surface& surface) {
  const std::size_t count = surface.primitive->positions.size();
  std::vector<Vec3> at(count);
  for (std::size_t v = 0; v < count; ++v) at[v] = surface.position(std::uint32_t(v));
  std::vector<std::uint32_t> order(count), first(count);
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t v) { return std::tuple(at[v].x, at[v].y, at[v].z, v); };
  std::ranges::sort(order, {}, key);
  for (std::size_t i = 0; i < count; ++i)
    first[order[i]] = i > 0 && at[order[i]] == at[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

/// Sets of vertices that triangles connect.
class Connected {
 public:
  explicit Connected(std::size_t vertices) : parent_(vertices) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// An edge of a triangle. `forth`: from the smaller to the larger vertex.
struct Edge {
  std::uint32_t a, b;
  bool forth;
  auto operator<=>(const Edge&) const = default;
};

/// True if each edge of the triangles is run through once in each direction.
bool is_closed(std::vector<Edge>& edges) {
  std::ranges::sort(edges);
  if (edges.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    const Edge &back = edges[i], &forth = edges[i + 1];
    if (back.a != forth.a || back.b != forth.b || back.forth || !forth.forth) return false;
    if (i + 2 < edges.size() && edges[i + 2].a == back.a && edges[i + 2].b == back.b) return false;
  }
  return true;
}

/// One of the two faces.
struct Face {
  std::vector<std::uint32_t> triangles;
  Vec3d sum{};  ///< of area times normal
  double area = 0, deviation = 0, lowest = INFINITY, highest = -INFINITY;
};

/// A triangle's outward normal times its area [m^2].
Vec3d area_normal(const Surface& surface, const std::array<std::uint32_t, 3>& corner) {
  const Vec3d a(surface.position(corner[0]));
  const Vec3d cross_product =
      cross(Vec3d(surface.position(corner[1])) - a, Vec3d(surface.position(corner[2])) - a) * 0.5;
  return surface.flipped ? -cross_product : cross_product;
}

/// Measures a face against its normal. False if the shading normals do not follow it.
bool measure(const Surface& surface, Vec3d normal, Face& face) {
  for (const std::uint32_t t : face.triangles) {
    const auto& corner = surface.primitive->triangles[t];
    const Vec3d n = area_normal(surface, corner);
    const double area = length(n);
    if (area > 0) face.deviation += area * length(n / area - normal) / face.area;
    for (const std::uint32_t v : corner) {
      const double height = dot(Vec3d(surface.position(v)), normal);
      face.lowest = std::min(face.lowest, height), face.highest = std::max(face.highest, height);
      if (surface.smooth() && length(Vec3d(surface.normal(v)) - normal) > kShadingTilt) return false;
    }
  }
  return true;
}

/// Sets the plate of a closed part; false if the part is none.
bool is_plate(const Surface& surface, Plate& plate) {
  Vec3d about{};
  double largest = 0, total = 0;
  std::vector<Vec3d> normals;
  for (const std::uint32_t t : plate.triangles) {
    normals.push_back(area_normal(surface, surface.primitive->triangles[t]));
    const double area = length(normals.back());
    total += area;
    if (area > largest) largest = area, about = normals.back() / area;
  }
  if (!(largest > 0)) return false;
  Face above, below;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const double area = length(normals[i]), along = dot(normals[i], about);
    if (std::abs(along) <= kFaceCosine * area) continue;
    Face& face = along > 0 ? above : below;
    face.triangles.push_back(plate.triangles[i]);
    face.sum = face.sum + normals[i];
    face.area += area;
  }
  if (!(above.area > 0 && below.area > 0) || total - above.area - below.area > kLargestRim * total) return false;
  if (std::abs(above.area - below.area) > kLargestRim * above.area) return false;
  const Vec3d normal = normalize(above.sum - below.sum);
  if (!measure(surface, normal, above) || !measure(surface, -normal, below)) return false;
  const double thickness = (above.lowest + above.highest + below.lowest + below.highest) / 2;
  if (!(thickness > 0) || std::max(above.deviation, below.deviation) > kLargestTilt) return false;
  if (std::max(above.highest - above.lowest, below.highest - below.lowest) > kSameThickness * thickness) return false;
  plate.face = std::move(above.triangles);
  plate.normal = Vec3(normal);
  plate.thickness = float(thickness);
  return true;
}

constexpr std::uint32_t kPlaces = 32;       ///< on a face; a ray starts below each, and one at the other face
constexpr std::uint32_t kMostBlocked = 16;  ///< of 64 rays
constexpr float kBelowFace = 0.01f;  ///< of the thickness: where rays start, and by how much they pass the other face

/// True if most rays that cross the plate from just below one face meet the other face first.
bool is_free(const Tracer& tracer, std::uint32_t number, const Plate& plate) {
  const Surface& surface = tracer.frame().surfaces[number];
  std::vector<double> areas;  // up to and including each triangle
  double sum = 0;
  for (const std::uint32_t t : plate.face)
    areas.push_back(sum += length(area_normal(surface, surface.primitive->triangles[t])));
  std::uint32_t blocked = 0;
  for (std::uint32_t i = 0; i < kPlaces; ++i) {
    const auto chosen = std::ranges::upper_bound(areas, sum * (i + 0.5) / kPlaces) - areas.begin();
    const auto& corner = surface.primitive->triangles[plate.face[std::min(std::size_t(chosen), areas.size() - 1)]];
    Vec2 u = sobol_owen_2d(i, 0);
    if (u.x + u.y > 1) u = {1 - u.x, 1 - u.y};
    const Vec3 a = surface.position(corner[0]),
               on_face = a + (surface.position(corner[1]) - a) * u.x + (surface.position(corner[2]) - a) * u.y;
    for (const float side : {1.0f, -1.0f}) {
      const float below = plate.thickness * (side > 0 ? 1 - kBelowFace : kBelowFace);
      const Ray ray{on_face - plate.normal * below, plate.normal * side, 0, plate.thickness};
      Hit hit;
      blocked += !tracer.intersect(ray, hit) || hit.surface != number || hit.t < plate.thickness * (1 - 2 * kBelowFace);
    }
  }
  return blocked <= kMostBlocked;
}

}  // namespace

std::vector<Plate> find_plates(const Surface& surface) {
  const auto& triangles = surface.primitive->triangles;
  const std::vector<std::uint32_t> vertex = welded(surface);
  Connected parts(vertex.size());
  for (const auto& t : triangles) parts.join(vertex[t[0]], vertex[t[1]]), parts.join(vertex[t[0]], vertex[t[2]]);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_part;  // root, triangle
  for (std::uint32_t t = 0; t < triangles.size(); ++t) by_part.emplace_back(parts.root(vertex[triangles[t][0]]), t);
  std::ranges::sort(by_part);
  std::vector<Plate> plates;
  for (std::size_t i = 0; i < by_part.size();) {
    Plate plate;
    std::vector<Edge> edges;
    for (const std::uint32_t part = by_part[i].first; i < by_part.size() && by_part[i].first == part; ++i) {
      const auto& corner = triangles[by_part[i].second];
      plate.triangles.push_back(by_part[i].second);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = vertex[corner[k]], b = vertex[corner[(k + 1) % 3]];
        edges.push_back({std::min(a, b), std::max(a, b), a < b});
      }
    }
    if (is_closed(edges) && is_plate(surface, plate)) plates.push_back(std::move(plate));
  }
  return plates;
}

PlatesOfSurfaces free_plates(const Tracer& tracer, const std::vector<std::uint32_t>& surfaces) {
  PlatesOfSurfaces all;
  for (const std::uint32_t number : surfaces) {
    const Surface& surface = tracer.frame().surfaces[number];
    if (!surface.primitive) continue;
    std::vector<float> thickness;
    for (const Plate& plate : find_plates(surface)) {
      if (!is_free(tracer, number, plate)) continue;
      thickness.resize(surface.primitive->triangles.size());
      for (const std::uint32_t t : plate.triangles) thickness[t] = plate.thickness;
    }
    if (!thickness.empty()) all.emplace(number, std::move(thickness));
  }
  return all;
}

}  // namespace tempolux
