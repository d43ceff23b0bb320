#include "lib/scene/gltf_mend.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tempolux::gltf {
namespace {

/// Index of a vertex in the list; the list's size if the vertex is not there.
std::size_t find(const std::vector<std::uint32_t>& sorted, std::uint32_t vertex) {
  const auto at = std::ranges::lower_bound(sorted, vertex);
  return at != sorted.end() && *at == vertex ? std::size_t(at - sorted.begin()) : sorted.size();
}

/// The triangle's normal times its angle at `corner`; zero if the triangle has no area.
Vec3d at_corner(const Primitive& primitive, const std::array<std::uint32_t, 3>& triangle, std::size_t corner) {
  const Vec3d p(primitive.positions[triangle[corner]]);
  const Vec3d a = Vec3d(primitive.positions[triangle[(corner + 1) % 3]]) - p;
  const Vec3d b = Vec3d(primitive.positions[triangle[(corner + 2) % 3]]) - p;
  const Vec3d normal = cross(a, b);
  if (length2(normal) == 0) return {};
  return normalize(normal) * std::atan2(std::sqrt(length2(normal)), dot(a, b));
}

}  // namespace

void mend_normals(Import& import, const std::string& place, const std::vector<std::uint32_t>& unusable,
                  Primitive& primitive) {
  if (unusable.empty()) return;
  std::vector<Vec3d> sums(unusable.size());
  std::vector<bool> used(unusable.size(), false);
  for (const auto& triangle : primitive.triangles)
    for (std::size_t corner = 0; corner < 3; ++corner)
      if (const std::size_t at = find(unusable, triangle[corner]); at < unusable.size()) {
        used[at] = true;
        sums[at] = sums[at] + at_corner(primitive, triangle, corner);
      }
  for (std::size_t i = 0; i < unusable.size(); ++i) {
    if (!used[i]) continue;
    const Vec3d unit = normalize(sums[i]);
    if (length2(unit) == 0) {
      import.ignore("normals of zero length (their primitives are flat shaded)");
      primitive.normals.clear();
      return;
    }
    primitive.normals[unusable[i]] = Vec3(unit);
  }
  if (const auto count = std::ranges::count(used, true); count > 0)
    import.mend(place, "normals of zero length, NaN or infinity are made from the triangles there", std::size_t(count));
}

void mend_from_neighbours(const Primitive& primitive, const std::vector<std::uint32_t>& unusable,
                          std::span<float> values, std::size_t components) {
  if (unusable.empty()) return;
  std::vector<double> sums(unusable.size() * components, 0), counts(unusable.size(), 0);
  for (const auto& triangle : primitive.triangles)
    for (const std::uint32_t vertex : triangle) {
      const std::size_t at = find(unusable, vertex);
      if (at == unusable.size()) continue;
      for (const std::uint32_t other : triangle) {
        if (find(unusable, other) < unusable.size()) continue;
        counts[at] += 1;
        for (std::size_t c = 0; c < components; ++c)
          sums[at * components + c] += double(values[other * components + c]);
      }
    }
  for (std::size_t i = 0; i < unusable.size(); ++i)
    for (std::size_t c = 0; c < components; ++c)
      values[unusable[i] * components + c] = counts[i] > 0 ? float(sums[i * components + c] / counts[i]) : 0.0f;
}

}  // namespace tempolux::gltf
