#include "lib/density/flux_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <set>
#include <vector>

#include "lib/core/random.h"

namespace tempolux {
namespace {

/// The grid starts an irrational part of an edge away from the origin. Surfaces often lie at round coordinates; if
/// the border of two cubes did, too, rounding would distribute the surface's records over both cubes.
constexpr double kShift = 0.38196601125;  // 2 - golden ratio
/// If a cell's area comes from the hull and the cell has fewer records than this, it keeps all light. With eight
/// records the relative error of the area is one half (rms; measured in tests/lib/density/split_light_test.cpp), which
/// is too uncertain to call a cell bright.
constexpr std::uint64_t kFewest = 8;
/// Records that CellEdge keeps. They fill 64 cells, so the number of cells, and with it the edge squared, has an error
/// of about 1 / sqrt(64) = 12 %: less than a step of CellEdge::edge(), which is 41 % of the edge squared.
constexpr std::size_t kPlaces = 64 * kRecordsPerCell;

int axis_of(Vec3 normal) {
  const Vec3 size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// Position of a coordinate in the grid, in edges.
double grid_of(float x, double edge) { return double(x) / edge + kShift; }

}  // namespace

FluxCells::FluxCells(double edge, double area_of_record) : edge_(edge), area_of_record_(area_of_record) {}

std::size_t FluxCells::Hash::operator()(const Key& key) const {
  std::uint64_t h = key.side;
  for (const std::int64_t i : key.cube) h = mix64(h ^ std::uint64_t(i) * 0x9e3779b97f4a7c15ull);
  return h;
}

FluxCells::Key FluxCells::key_of(const CellPlace& place) const {
  Key key{};
  constexpr double most = 4e18;  // keeps the number of a distant cube within 64 bits
  for (int a = 0; a < 3; ++a)
    key.cube[std::size_t(a)] = std::int64_t(std::clamp(std::floor(grid_of(place.position[a], edge_)), -most, most));
  const int axis = axis_of(place.normal);
  key.side = std::uint32_t(place.object) << 3 | std::uint32_t(axis) << 1 | std::uint32_t(place.normal[axis] < 0);
  return key;
}

void FluxCells::add(const CellPlace& place, const std::array<float, 3>& flux) {
  Cell& cell = cells_[key_of(place)];
  for (std::size_t c = 0; c < 3; ++c) cell.flux[c].add(flux[c]);
  ++cell.count;
  if (area_of_record_ > 0) return;
  const int axis = axis_of(place.normal);
  const auto within = [&](int a) {
    const double at = grid_of(place.position[a], edge_);
    return at - std::floor(at);
  };
  cell.hull.add(within((axis + 1) % 3), within((axis + 2) % 3));
  // The largest component of a unit vector is at least 1 / sqrt(3) = 0.577.
  cell.slant += std::uint64_t(65536.0 / std::max(0.577, double(std::abs(place.normal[axis]))));
}

double FluxCells::area_of(const Cell& cell) const {
  if (area_of_record_ > 0) return double(cell.count) * area_of_record_;
  return cell.hull.area() * edge_ * edge_ * (double(cell.slant) / 65536 / double(cell.count));
}

void FluxCells::close(double limit) {
  struct Figures {
    Key key;
    Cell* cell;
    double area, flux;
  };
  std::vector<Figures> all;
  for (auto& [key, cell] : cells_) {
    const double flux = cell.flux[0].value() + cell.flux[1].value() + cell.flux[2].value();
    if (flux > 0) all.push_back({key, &cell, area_of(cell), flux});
  }
  std::sort(all.begin(), all.end(), [](const Figures& a, const Figures& b) { return a.key < b.key; });
  area_ = flux_ = 0;
  for (const Figures& f : all) area_ += f.area, flux_ += f.flux;

  bright_ = 0;
  for (const Figures& f : all) {
    const double kept = limit * mean_irradiance() * f.area;
    const bool unknown = limit > 0 && area_of_record_ <= 0 && f.cell->count < kFewest;
    // If limit or mean are infinite, `kept` may be NaN (0 * inf): the cell then keeps all light.
    f.cell->low_share = unknown || !(kept < f.flux) ? 1 : kept / f.flux;
    bright_ += f.cell->low_share < 1;
  }
}

double FluxCells::low_share(const CellPlace& place) const {
  const auto cell = cells_.find(key_of(place));
  return cell == cells_.end() ? 1 : cell->second.low_share;
}

void CellEdge::add(Vec3 position) {
  ++total_;
  std::uint64_t hash = 0;
  for (int a = 0; a < 3; ++a) hash = mix64(hash + std::bit_cast<std::uint32_t>(position[a]) + 0x9e3779b97f4a7c15ull);
  if (places_.size() == kPlaces && hash > places_.rbegin()->first) return;
  ++places_.try_emplace(hash, Place{position}).first->second.count;
  if (places_.size() > kPlaces) places_.erase(std::prev(places_.end()));
}

double CellEdge::edge() const {
  Box3 bounds;
  std::uint64_t records = 0;
  for (const auto& [hash, place] : places_) bounds.add(place.position), records += place.count;
  if (places_.size() < 2) return 1;
  double edge = double(max_component(bounds.upper - bounds.lower));
  if (!(edge > 0)) return 1;  // -0 and 0 are the same position
  // Starts with all records in one cell and divides the edge by 2^(1/4) until a cell holds the wanted number of the
  // kept records on average.
  for (int step = 0; step < 100; ++step, edge *= 0.8408964152537145) {  // 2^(-1/4)
    std::set<std::array<std::int64_t, 3>> cells;
    for (const auto& [hash, place] : places_) {
      std::array<std::int64_t, 3> cube{};
      for (int a = 0; a < 3; ++a) cube[std::size_t(a)] = std::int64_t(std::floor(grid_of(place.position[a], edge)));
      cells.insert(cube);
    }
    if (records <= kRecordsPerCell * cells.size()) break;
  }
  // On surfaces the number of records in a cell grows with the square of its edge.
  return std::max(edge * std::sqrt(double(records) / double(total_)), 1e-30);
}

}  // namespace tempolux
