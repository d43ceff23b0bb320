// lib/density/energy_cells.h -- how much light lies where, by cells; which cells are bright (docs/methods/split.md).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include "lib/core/vec.h"
#include "lib/density/planar_hull.h"
#include "lib/density/window_sum.h"

namespace tempolux {

/// Where a record lies.
struct CellPlace {
  Vec3 position;             ///< m
  Vec3 normal;               ///< unit: on the side that is lit
  std::uint16_t object = 0;  ///< id.object
};

/// What makes a cell bright.
struct EnergyLimit {
  double times_mean = 4;               ///< >= 0: a cell keeps at most this multiple of the mean irradiance
  std::optional<double> records = {};  ///< if given, instead: at most the energy of so many records of mean energy
};

/// Cells of one edge: records whose positions lie in the same cube of a grid, on the same object, and whose normals are
/// nearest to the same of the six axes. Each cell adds up the energy of its records [W] without error, so that nothing
/// below depends on their order.
class EnergyCells {
 public:
  /// `edge`: m, > 0. `area_of_record`: m^2 that each record stands for; 0: not known, and a cell's area is that of the
  /// convex hull of its records' positions, seen along its axis (PlanarHull).
  EnergyCells(double edge, double area_of_record);

  /// First pass: a record with this flux [W] (times the share that is reflected, where known). Finite; magnitudes
  /// count.
  void add(const CellPlace& place, const std::array<float, 3>& flux);
  /// After the first pass: finds what each cell keeps.
  void close(const EnergyLimit& limit);

  /// Second pass: the share in [0, 1] of each record here that stays in the low part; 1 of a cell not seen.
  double low_share(const CellPlace& place) const;

  std::size_t size() const { return cells_.size(); }
  std::size_t bright_count() const { return bright_; }  ///< cells that keep less than all
  double area() const { return area_; }                 ///< m^2: of all cells that have energy
  double energy() const { return energy_; }             ///< W: of all records, channels added
  /// W/m^2, channels added: energy() / area(); 0 without area.
  double mean_irradiance() const { return area_ > 0 ? energy_ / area_ : 0; }

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
    std::uint64_t slant = 0;  ///< sum of 1 / |cosine of the normal to the axis|, in units of 2^-16
    PlanarHull hull;
    double low_share = 1;
  };
  Key key_of(const CellPlace& place) const;
  double area_of(const Cell& cell) const;

  double edge_, area_of_record_;
  std::unordered_map<Key, Cell, Hash> cells_;
  std::size_t bright_ = 0;
  double area_ = 0, energy_ = 0;
};

/// Finds the edge of cells that hold 256 records each in the mean: on surfaces, squares 16 mean distances wide. Keeps
/// the records with the smallest hashes of their positions, 16384 places, so that memory is bounded and order does not
/// matter.
class CellEdge {
 public:
  void add(Vec3 position);
  /// m, > 0. Of no records, or of all in one point: 1.
  double edge() const;

 private:
  struct Place {
    std::uint64_t hash;
    Vec3 position;
    std::uint64_t count;
  };
  std::unordered_map<std::uint64_t, std::size_t> index_;  ///< of places_ by hash
  std::vector<Place> places_;
  std::uint64_t limit_ = ~std::uint64_t(0), total_ = 0;
  void trim();
};

}  // namespace tempolux
