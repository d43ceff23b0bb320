#include "lib/density/morton.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "lib/core/parallel_each.h"

namespace tempolux {
namespace {

constexpr std::size_t kCodeChunk = 1 << 14;

/// How coordinates become cells, and how the bits of cells are interleaved in the code.
struct CurveLayout {
  Vec3 lower, scale;  // the cell's number along an axis is (p - lower) * scale, rounded down
  std::array<float, 3> last_cell{};
  std::array<std::uint32_t, 3> bits{};  // by axis: mask of the code's bits that belong to the axis

  explicit CurveLayout(const Box3& box) : lower(box.lower) {
    const Vec3 extent = box.upper - box.lower;
    Vec3 cell = extent;
    std::array<int, 3> count{};
    for (int bit = 31; bit >= 0; --bit) {
      int axis = cell.x >= cell.y ? 0 : 1;
      if (cell.z > cell[axis]) axis = 2;
      if (count[std::size_t(axis)] == 24) axis = (axis + 1) % 3;  // a float has 24 bits; another axis gets the next bit
      bits[std::size_t(axis)] |= 1u << bit;
      ++count[std::size_t(axis)];
      cell[axis] *= 0.5f;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const float cells = float(1u << count[std::size_t(axis)]);
      last_cell[std::size_t(axis)] = cells - 1;
      scale[axis] = extent[axis] > 0 && std::isfinite(cells / extent[axis]) ? cells / extent[axis] : 0.0f;
    }
  }

  std::uint32_t code(Vec3 p) const {
    if (!is_finite(p)) return 0;
    std::uint32_t result = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float cell = std::min((p[axis] - lower[axis]) * scale[axis], last_cell[std::size_t(axis)]);
      result |= _pdep_u32(std::uint32_t(cell), bits[std::size_t(axis)]);
    }
    return result;
  }
};

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const Vec3> points) {
  if (points.size() > 0xffffffffu) throw std::length_error("morton_order: more than 2^32 - 1 points");
  Box3 box;
  for (Vec3 p : points)
    if (is_finite(p)) box.add(p);
  const CurveLayout layout(box.empty() ? Box3{{}, {}} : box);

  std::vector<std::uint64_t> items(points.size());  // code and index
  parallel_each(points.size(), kCodeChunk,
                [&](std::size_t i) { items[i] = std::uint64_t(layout.code(points[i])) << 32 | i; });
  std::ranges::sort(items);
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = std::uint32_t(items[i]);
  return order;
}

}  // namespace tempolux
