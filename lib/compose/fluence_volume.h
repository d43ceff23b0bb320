// lib/compose/fluence_volume.h -- fluence inside media from tentative photons: exact sums by cell, then filtered.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/light_texture/mesh_elements.h"
#include "lib/volume/majorants.h"

namespace tempolux {

/// Sums of photon flux over the cells of a grid, which covers the majorants' box and divides each majorant cell into
/// equal cells. A cell holds, by channel, the sum of flux / majorant [W m] of its photons as a 64-bit multiple of
/// unit(). Such sums are exact: a photon that is added and subtracted again leaves no trace, whatever the order.
class FluenceSums {
 public:
  static constexpr std::uint64_t kMostCells = std::uint64_t(1) << 25;

  FluenceSums() = default;
  /// `emitted_flux` [W]: that of all lights, summed over channels. The unit is a power of two, about 2^-44 of this flux
  /// times the box's diagonal. A sum can then hold 2^19 times the contribution of photons of all flux that cross the
  /// box once. `cell` [m]: largest edge of a cell; cells are larger only if there would be more than kMostCells.
  FluenceSums(const MajorantGrid& majorants, double cell, double emitted_flux);

  const Box3& box() const { return box_; }
  const std::array<std::int32_t, 3>& counts() const { return counts_; }
  double unit() const { return unit_; }  ///< W m
  /// Volume of a cell, m^3.
  double cell_volume() const;
  /// Index of the cell that holds a scene-space point; the product of counts() outside the box.
  std::size_t cell_of(Vec3 point) const;
  /// Adds (times = 1) or subtracts (-1) a photon's contribution [W m]. A contribution that is not finite, or a point
  /// outside the box, is ignored.
  void add(Vec3 point, Rgb contribution, int times = 1);
  const std::vector<std::array<std::int64_t, 3>>& sums() const { return sums_; }
  std::uint64_t photons() const { return photons_; }
  /// One entry per cell: true if its majorant is above 0, so that tentative collisions can happen in it.
  const std::vector<std::uint8_t>& open() const { return open_; }
  /// True if cells and sums are equal.
  bool operator==(const FluenceSums& other) const {
    return counts_ == other.counts_ && unit_ == other.unit_ && photons_ == other.photons_ && sums_ == other.sums_;
  }

 private:
  Box3 box_;
  std::array<std::int32_t, 3> counts_{};
  Vec3 cells_per_m_;
  double unit_ = 1;
  std::uint64_t photons_ = 0;
  std::vector<std::array<std::int64_t, 3>> sums_;
  std::vector<std::uint8_t> open_;
};

inline constexpr auto kPhotonsInFilter = float(kPhotonsInKernel);  ///< photons under a filter of automatic width

/// Fluence [W/m^2] at any place: filtered sums divided by filtered volumes, interpolated trilinearly between the
/// centres of cells. The volume of cells without a medium is 0, so that cells at the border of a medium are not too
/// dark. 0 outside the box.
class FluenceVolume {
 public:
  FluenceVolume() = default;
  /// `width`: standard deviation of the Gaussian, cells; 0: so that about kPhotonsInFilter photons count.
  FluenceVolume(const FluenceSums& sums, float width);
  /// Filtered fluence [W/m^2] at a point, scene space.
  Rgb at(Vec3 point) const;
  float width() const { return width_; }  ///< cells: the width that was used, given or automatic

 private:
  Box3 box_;
  std::array<std::int32_t, 3> counts_{};
  Vec3 cells_per_m_;
  float width_ = 0;
  std::vector<std::array<float, 4>> cells_;  ///< sum [W m] and volume [m^3], both filtered
};

}  // namespace tempolux
