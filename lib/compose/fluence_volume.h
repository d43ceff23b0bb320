// lib/compose/fluence_volume.h -- light inside media, from tentative photons: sums by cells that can be undone, then
// filtered.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/volume/majorants.h"

namespace tempolux {

/// Cells over the box of the majorants, each cut into `per_majorant`^3. Of every channel the sum of what photons are
/// worth (flux / majorant, W m) is kept as a multiple of `unit` in 64 bits: adding a photon and taking it away again
/// leaves exactly what was there, in any order.
class FluenceSums {
 public:
  static constexpr std::uint64_t kMostCells = std::uint64_t(1) << 25;

  FluenceSums() = default;
  /// `emitted_flux` [W]: of the lamps, all channels together; gives the unit: 2^-44 of that flux along the box's
  /// diagonal, a power of two. So a sum holds 2^19 times what all photons could be worth that pass the box once. `cell`
  /// [m]: their size is this or a little less, more where kMostCells would be exceeded.
  FluenceSums(const MajorantGrid& majorants, double cell, double emitted_flux);

  const Box3& box() const { return box_; }
  const std::array<std::int32_t, 3>& counts() const { return counts_; }
  double unit() const { return unit_; }
  /// m^3.
  double cell_volume() const;
  /// Index of the cell of a scene-space point; counts()'s product if it lies outside the box.
  std::size_t cell_of(Vec3 point) const;
  /// Adds (times = 1) or takes away (-1) a photon's worth [W m]. Not finite or outside: nothing.
  void add(Vec3 point, Rgb worth, int times = 1);
  const std::vector<std::array<std::int64_t, 3>>& sums() const { return sums_; }
  std::uint64_t photons() const { return photons_; }
  /// Can tentative collisions happen in the cell: is its majorant above 0?
  const std::vector<std::uint8_t>& open() const { return open_; }
  /// The same cells, with the same sums.
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

inline constexpr float kPhotonsInFilter =
    256;  ///< that count in a filter whose width is not given: noise of a cell 1/16

struct FluenceFilter {
  enum class Kind : std::uint8_t { none, box, gaussian, bilateral };
  Kind kind = Kind::gaussian;
  float width =
      0;  ///< cells: half the box's edge, or the Gaussian's standard deviation; 0: so wide that about 256 photons count
  float range = 0.5f;  ///< bilateral: standard deviation of ln fluence over which cells count as alike
};

/// Fluence [W/m^2] at any place: sums over volumes, both filtered by the same kernel, so that cells at the border of
/// what photons can reach lose nothing; between the cells' centres trilinear. 0 outside.
class FluenceVolume {
 public:
  FluenceVolume() = default;
  FluenceVolume(const FluenceSums& sums, const FluenceFilter& filter);
  Rgb at(Vec3 point) const;
  float width() const { return width_; }  ///< cells: that of the filter, also where it was 0

 private:
  Box3 box_;
  std::array<std::int32_t, 3> counts_{};
  Vec3 cells_per_m_;
  float width_ = 0;
  std::vector<std::array<float, 4>> cells_;  ///< sum [W m] and volume [m^3], both filtered
};

}  // namespace tempolux
