#include "lib/light_texture/mesh_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/octahedral.h"
#include "lib/core/arrays.h"
#include "lib/core/random.h"
#include "lib/irradcache/clearance.h"

namespace tempolux {
namespace {

constexpr float kSamePlace = 1e-3f;  ///< share of a cell: corners closer than this coincide

/// The key of a side of a triangle: 32 bits of surface, 31 of triangle, one of side.
std::uint64_t key(std::uint32_t surface, std::uint32_t triangle, std::uint32_t side) {
  return std::uint64_t(surface) << 32 | std::uint64_t(triangle & 0x7fffffffu) << 1 | side;
}

/// Index of a corner among the corners of its side, whose edges are cut into n parts.
std::uint32_t corner(std::uint32_t n, std::uint32_t column, std::uint32_t row) {
  return row * (n + 1) - row * (row - 1) / 2 + column;
}

/// Columns and rows of the three corners of a cell.
std::array<std::array<std::uint32_t, 2>, 3> corners_of(const formats::MeshPlace& p) {
  if (p.tip) return {{{p.column + 1, p.row}, {p.column, p.row + 1}, {p.column + 1, p.row + 1}}};
  return {{{p.column, p.row}, {p.column + 1, p.row}, {p.column, p.row + 1}}};
}

std::uint64_t place_of(Vec3 p, float step) {
  std::uint64_t hash = 0;
  for (int c = 0; c < 3; ++c)
    hash = mix64(hash + std::uint64_t(std::int64_t(std::floor(double(p[c]) / double(step) + 0.5))));
  return hash;
}

}  // namespace

MeshLight::MeshLight(const formats::MeshirradFile& file, const SceneFrame& frame)
    : size_(file.elements.size()), caustic_(file.header.kinds == "caustic,indirect") {
  const std::vector<formats::MeshElement>& elements = file.elements;
  std::vector<Meeting> meetings;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < elements.size();) {
    const formats::MeshElement& e = elements[i];
    const std::uint32_t n = e.cuts;
    sides_.emplace(key(e.surface, e.triangle, e.side), Side{count, n});
    const Surface& s = frame.surfaces.at(e.surface);
    const auto& index = s.primitive->triangles.at(e.triangle);
    const Vec3 a = s.position(index[0]), b = s.position(index[1]), c = s.position(index[2]);
    for (std::uint32_t cell = 0; cell < n * n; ++cell, ++i) {
      const auto [u, v] = formats::mesh_cell_centre(n, cell);
      for (const auto& [column, row] : corners_of(formats::mesh_place(n, u, v))) {
        const float x = float(column) / float(n), y = float(row) / float(n);
        const Vec3 place = a * (1 - x - y) + b * x + c * y;
        meetings.push_back(
            {place_of(place, kSamePlace * float(file.header.cell)), std::uint32_t(i), count + corner(n, column, row)});
      }
    }
    count += (n + 1) * (n + 2) / 2;
  }
  corners_.resize(count);
  join(meetings, elements, frame);
}

void MeshLight::join(std::vector<Meeting>& meetings, const std::vector<formats::MeshElement>& elements,
                     const SceneFrame& frame) {
  std::sort(meetings.begin(), meetings.end());
  const auto material = [&](const Meeting& m) { return frame.surfaces[elements[m.element].surface].material; };
  const auto normal = [&](const Meeting& m) { return vec_of(formats::decode_normal(elements[m.element].normal)); };
  for (std::size_t first = 0, last = 0; first < meetings.size(); first = last) {
    while (last < meetings.size() && meetings[last].place == meetings[first].place) ++last;
    for (std::size_t m = first; m < last; ++m) {
      Rgbd sum{0.0};
      double area = 0;
      for (std::size_t k = first; k < last; ++k) {
        const formats::MeshElement& e = elements[meetings[k].element];
        if (material(meetings[m]) != material(meetings[k]) ||
            dot(normal(meetings[m]), normal(meetings[k])) < Clearance::kBend)
          continue;
        sum += Rgbd(rgb_of(e.irradiance)) * double(e.area);
        area += double(e.area);
      }
      if (area > 0) corners_[meetings[m].corner] = Rgb(sum * (1 / area));
    }
  }
}

Rgb MeshLight::irradiance(const SurfacePoint& hit, Vec3 geometric) const {
  const auto found = sides_.find(key(hit.surface, hit.triangle, dot(hit.normal_geometric, geometric) < 0));
  if (found == sides_.end()) return Rgb(0.0f);
  const Side& side = found->second;
  const formats::MeshPlace p = formats::mesh_place(side.cuts, hit.u, hit.v);
  const std::array<float, 3> weights =
      p.tip ? std::array{1 - p.y, 1 - p.x, p.x + p.y - 1} : std::array{1 - p.x - p.y, p.x, p.y};
  const auto corners = corners_of(p);
  Rgb sum{0.0f};
  for (std::size_t k = 0; k < 3; ++k) {
    const Rgb& there = corners_[side.first + corner(side.cuts, corners[k][0], corners[k][1])];
    sum += there * std::clamp(weights[k], 0.0f, 1.0f);
  }
  return sum;
}

}  // namespace tempolux
