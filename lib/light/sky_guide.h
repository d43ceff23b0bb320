// lib/light/sky_guide.h -- the directions in which places see the environment, learned from rays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// Densities of directions in which surfaces see the environment, by place and by the axis that the normal is closest
/// to. Learned from rays that left `places` with the density cos / pi and met no surface.
///
/// The hits are halved at their median, along the longest side of their box, while each half has kLeastHits. Each part
/// has a grid of kRows x kColumns cells of equal solid angle. A cell is drawn by the weight of the hits in and around
/// it, and a direction inside the cell uniformly. Where more than kMostSeen of the rays meet the environment there is
/// no grid: such rays deviate by at most 300 % of their mean. A part with fewer than kLeastHits has no grid, either.
/// Derivation and measurements: docs/pixels.md.
class SkyGuide {
 public:
  struct Place {
    Vec3 position, normal;  ///< scene space; unit normal on the lit side
  };
  struct Hit {
    std::uint32_t place = 0;
    Vec3 direction;    ///< unit, towards the environment
    float weight = 0;  ///< radiance [any unit], above 0
  };
  static constexpr int kRows = 32, kColumns = 2 * kRows;
  static constexpr std::size_t kLeastHits = 64;
  static constexpr double kMostSeen = 0.1;

  SkyGuide() = default;
  /// Every place has sent `rays` rays. Hits must be in a fixed order; the guide then depends on nothing else.
  SkyGuide(std::span<const Place> places, std::vector<Hit> hits, int rays);

  class Grid {
   public:
    explicit Grid(std::span<const Hit> hits);
    /// Draws a unit direction; u1 and u2 are in [0, 1).
    Vec3 sample(double u1, double u2) const;
    /// Density [1/sr] with which sample() gives `direction` (unit).
    double pdf_solid_angle(Vec3 direction) const;

   private:
    std::array<float, kRows> row_end_{};                ///< cumulative shares
    std::array<float, kRows * kColumns> column_end_{};  ///< cumulative shares inside the row
    std::array<float, kRows * kColumns> density_{};     ///< [1/sr]
  };
  /// The grid for a place; null: none. A normal of zero has none.
  const Grid* at(Vec3 position, Vec3 normal) const;
  bool empty() const { return grids_.empty(); }

 private:
  struct Node {
    int axis = -1;  ///< -1: a leaf
    float split = 0;
    std::uint32_t left = 0, right = 0;  ///< of a leaf `left` is the number of its grid, kNoGrid: none
  };
  static constexpr std::uint32_t kNoGrid = 0xffffffff;
  struct Builder;
  std::vector<Node> nodes_;
  std::vector<Grid> grids_;
  std::array<std::uint32_t, 6> root_{};  ///< by the normal's axis and sign
};

}  // namespace tempolux
