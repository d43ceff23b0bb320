#include "lib/gather/world_places.h"

#include <utility>

#include "lib/core/parallel_each.h"

namespace tempolux {
namespace {

/// Cells of a column through which one line runs. A line is much longer than the spacing, so that few lines are empty.
constexpr int kChunk = 8;
/// Most crossings of a line that become places: bounds the time at stacks of surfaces, such as foliage.
constexpr std::uint32_t kMostCrossings = 64;
/// An axis counts for a wanted normal if the normal's component along it is at least this. The normal of a place of the
/// axis is within acos(1 / sqrt 3) = 54.7 degrees of the axis, and within 20 degrees of the wanted normal; cos 74.7 =
/// .264, rounded down.
constexpr float kLeastComponent = 0.26f;

/// Bit of a direction along an axis: 2 axis for the positive one, 2 axis + 1 for the negative one.
constexpr std::uint8_t side_bit(int axis, bool negative) { return std::uint8_t(1u << (2 * axis + negative)); }

/// Part of a column of cells along an axis.
struct Column {
  std::int32_t u = 0, v = 0,
               chunk = 0;  ///< u, v: cells along axes (axis + 1) % 3, (axis + 2) % 3; chunk: kChunk cells along `axis`
  std::uint8_t axis = 0;
  std::uint8_t sides = 0;  ///< bits of the wanted sides

  /// A number of 128 bits that names the column.
  std::pair<std::uint64_t, std::uint64_t> place() const {
    return {std::uint64_t(axis) << 32 | std::uint32_t(u), std::uint64_t(std::uint32_t(v)) << 32 | std::uint32_t(chunk)};
  }
  std::uint64_t key(int spacing_class) const {
    const auto [high, low] = place();
    return mix64(mix64(mix64(0x706c616365730001ull + std::uint64_t(spacing_class + 4096)) ^ high) ^ low);
  }
};

std::int32_t chunk_of(std::int32_t cell) { return cell >= 0 ? cell / kChunk : -((-cell + kChunk - 1) / kChunk); }

/// Sorts columns and joins equal ones.
void join_equal(std::vector<Column>& columns) {
  std::ranges::sort(columns, {}, &Column::place);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (kept > 0 && columns[kept - 1].place() == columns[i].place()) columns[kept - 1].sides |= columns[i].sides;
    else columns[kept++] = columns[i];
  }
  columns.resize(kept);
}

/// Adds the columns up to `reach` cells away along one of their coordinates.
void widen(int reach, std::int32_t Column::*along, std::vector<Column>& columns) {
  const std::size_t count = columns.size();
  columns.reserve(count * std::size_t(2 * reach + 1));
  for (std::size_t i = 0; i < count; ++i)
    for (std::int32_t d = -reach; d <= reach; ++d) {
      Column column = columns[i];
      column.*along += d;
      if (d != 0) columns.push_back(column);
    }
  join_equal(columns);
}

/// The columns within `reach` cells of the wanted places.
std::vector<Column> columns_around(const PlaceCells& grid, std::span<const WantedPlace> wanted, int reach) {
  std::vector<Column> columns;
  for (const WantedPlace& at : wanted) {
    const std::uint8_t sides = faced_axes(at.normal);
    for (int axis = 0; axis < 3; ++axis) {
      const auto own = std::uint8_t(sides & (3u << (2 * axis)));
      if (!own) continue;
      const std::int32_t w = grid.at(at.position, axis);
      for (std::int32_t chunk = chunk_of(w - reach); chunk <= chunk_of(w + reach); ++chunk)
        columns.push_back({grid.at(at.position, (axis + 1) % 3), grid.at(at.position, (axis + 2) % 3), chunk,
                           std::uint8_t(axis), own});
    }
  }
  join_equal(columns);
  // One coordinate after the other: a square of cells at once would name most columns many times.
  widen(reach, &Column::u, columns);
  widen(reach, &Column::v, columns);
  return columns;
}

/// Adds the places where the line of a column crosses surfaces.
void cross(const Tracer& tracer, const PlaceCells& grid, const Column& column, std::uint64_t key,
           std::vector<WorldPlace>& places) {
  const int axis = column.axis, across = (axis + 1) % 3, up = (axis + 2) % 3;
  Ray ray;
  // The line keeps a quarter of the spacing away from the sides of its column, so that no two lines are close.
  ray.origin[axis] = grid.local(double(column.chunk) * kChunk, axis);
  ray.origin[across] = grid.local(column.u + 0.25 + 0.5 * unit_double(key), across);
  ray.origin[up] = grid.local(column.v + 0.25 + 0.5 * unit_double(mix64(key)), up);
  ray.direction[axis] = 1;
  ray.t_max = float(kChunk * grid.spacing());
  for (std::uint32_t crossing = 0; crossing < kMostCrossings; ++crossing) {
    Hit hit;
    if (!tracer.intersect(ray, hit)) return;
    const SurfacePoint point = tracer.surface_point(hit);
    const Vec3 n = point.normal_geometric;
    if (std::abs(n[axis]) >= std::max(std::abs(n[across]), std::abs(n[up]))) {
      for (const bool negative : {false, true}) {
        if (!(column.sides & side_bit(axis, negative))) continue;
        const Vec3 side = (n[axis] < 0) == negative ? n : -n;
        places.push_back({point, side, mix64(key + 2 * crossing + negative) | 1});
      }
    }
    pass_surface(point, hit.t, ray);
  }
}

}  // namespace

float spacing_of(int spacing_class) { return float(std::exp2(0.5 * spacing_class)); }

std::uint8_t faced_axes(Vec3 normal) {
  std::uint8_t sides = 0;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(normal[axis]) >= kLeastComponent) sides |= side_bit(axis, normal[axis] < 0);
  return sides;
}

PlaceCells::PlaceCells(const Tracer& tracer, int spacing_class)
    : origin_(tracer.frame().origin), spacing_(std::exp2(0.5 * spacing_class)) {}

std::vector<WorldPlace> world_places(const Tracer& tracer, int spacing_class, float reach,
                                     std::span<const WantedPlace> wanted) {
  const PlaceCells grid(tracer, spacing_class);
  const int cells = int(std::ceil(double(reach) / grid.spacing()));
  const std::vector<Column> columns = columns_around(grid, wanted, cells);
  return parallel_found<WorldPlace>(columns.size(), 256, [&](std::size_t i, std::vector<WorldPlace>& found) {
    cross(tracer, grid, columns[i], columns[i].key(spacing_class), found);
  });
}

}  // namespace tempolux
