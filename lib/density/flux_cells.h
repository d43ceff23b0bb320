// lib/density/flux_cells.h -- sums flux by cells and finds the bright cells (docs/methods/split.md).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <unordered_map>

#include "lib/core/vec.h"
#include "lib/density/planar_hull.h"
#include "lib/density/window_sum.h"

namespace tempolux {

/// Position, normal and object of a record. They decide to which cell the record belongs.
struct CellPlace {
  Vec3 position;             ///< m
  Vec3 normal;               ///< unit, on the lit side
  std::uint16_t object = 0;  ///< id.object
};

/// A cell keeps at most this multiple of the mean irradiance. With half of the value gathering has the same variance at
/// 1.1 times the CPU seconds, with a quarter at 1.3 times (docs/notebook/split.md).
inline constexpr double kBrightLimit = 4;

/// Cells of one edge length, which sum the flux of records (photons or irradiance points). Two records belong to one
/// cell if their positions are in the same cube of a grid, they lie on the same object, and their normals are closest
/// to the same of the six axis directions. The sums [W] are exact, so that no result depends on the order of the
/// records.
class FluxCells {
 public:
  /// `edge`: m, > 0. `area_of_record`: area that each record represents, m^2. If it is 0 the area is unknown: a cell
  /// then estimates its area from the convex hull of its records' positions (PlanarHull).
  FluxCells(double edge, double area_of_record);

  /// First pass: adds a record with this flux [W], which must be finite; its magnitude counts. If the reflectance of
  /// the surface is known, the caller multiplies the flux by it.
  void add(const CellPlace& place, const std::array<float, 3>& flux);
  /// Ends the first pass: computes the share of light that each cell keeps. A cell keeps at most `limit` >= 0 times the
  /// mean irradiance.
  void close(double limit);

  /// Second pass: the share in [0, 1] of a record's light that stays in the low part; 1 if the cell has no records.
  double low_share(const CellPlace& place) const;

  std::size_t size() const { return cells_.size(); }
  std::size_t bright_count() const { return bright_; }  ///< number of cells that keep less than all
  double area() const { return area_; }                 ///< m^2: of all cells with flux
  double flux() const { return flux_; }                 ///< W: of all records, sum over the channels
  /// W/m^2, sum over the channels: flux over area; 0 without area.
  double mean_irradiance() const { return area_ > 0 ? flux_ / area_ : 0; }

 private:
  struct Key {
    std::array<std::int64_t, 3> cube;
    std::uint32_t side;  ///< axis and object
    bool operator==(const Key&) const = default;
    auto operator<=>(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  struct Cell {
    std::array<WindowSum, 3> flux;
    std::uint64_t count = 0;
    std::uint64_t slant = 0;  ///< sum over records of 1 / |cosine between normal and axis|, in units of 2^-16
    PlanarHull hull;
    double low_share = 1;
  };
  Key key_of(const CellPlace& place) const;
  double area_of(const Cell& cell) const;

  double edge_, area_of_record_;
  std::unordered_map<Key, Cell, Hash> cells_;
  std::size_t bright_ = 0;
  double area_ = 0, flux_ = 0;
};

/// Records in a cell of CellEdge, on average. If areas come from hulls, fewer records underestimate the area: on S3
/// (frame 1, 200 000 paths, lit area 144 m^2) the cells' areas add up to 53, 86, 125 and 138 m^2 with 11, 34, 114 and
/// 380 records on average.
inline constexpr std::size_t kRecordsPerCell = 256;

/// Finds the edge of cells that hold kRecordsPerCell records each on average: on surfaces, squares of so many mean
/// distances as its root wide. Keeps only the 16384 records whose positions have the smallest hashes, so that memory is
/// bounded and the result does not depend on the order of the records.
class CellEdge {
 public:
  void add(Vec3 position);
  /// m, > 0. 1 if there are no records or all records are at one point.
  double edge() const;

 private:
  struct Place {
    Vec3 position;
    std::uint64_t count = 0;  ///< records at this position
  };
  std::map<std::uint64_t, Place> places_;  ///< by hash
  std::uint64_t total_ = 0;                ///< number of records
};

}  // namespace tempolux
