// lib/light/sky_guide.h -- the directions in which places see the environment, learned from rays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// pdfs of directions in which surfaces see the environment, by place and by the axis that the normal is closest to.
/// The guide learns from rays that left places with the pdf cos / pi. A ray that reaches the environment is a hit.
///
/// Places are divided at the median of their hits, along the longest side of the box around the hits, while each half
/// has kLeastHits. Each part has a grid of kRows x kColumns cells of equal solid angle. A cell is drawn by the weight
/// of the hits in and around the cell; a direction inside the cell is drawn uniformly. A part has no grid if more than
/// kMostSeen of its rays are hits, because rays of pdf cos / pi then deviate by at most 300 % of their mean; nor if it
/// has fewer than kLeastHits hits. Derivation and measurements: docs/methods/lights.md.
class SkyGuide {
 public:
  struct Place {
    Vec3 position, normal;  ///< scene space, m; unit normal on the side that sends rays
  };
  struct Hit {
    std::uint32_t place = 0;  ///< index of the place that sent the ray
    Vec3 direction;           ///< unit, towards the environment
    float weight = 0;         ///< radiance [any unit], above 0
  };
  /// Half and twice the numbers of kRows and kLeastHits: docs/notebook/constants.md.
  static constexpr int kRows = 32, kColumns = 2 * kRows;
  static constexpr std::size_t kLeastHits = 64;
  static constexpr double kMostSeen = 0.1;

  SkyGuide() = default;
  /// Every place has sent `rays` rays. Hits must be in a fixed order; the guide then depends on nothing else.
  SkyGuide(std::span<const Place> places, std::vector<Hit> hits, int rays);

  /// A piecewise constant pdf over the sphere.
  class Grid {
   public:
    explicit Grid(std::span<const Hit> hits);
    /// Draws a unit direction; u1 and u2 are in [0, 1).
    Vec3 sample(double u1, double u2) const;
    /// pdf [1/sr] with which sample() gives `direction` (unit).
    double pdf_solid_angle(Vec3 direction) const;

   private:
    std::array<float, kRows> row_end_{};                ///< cumulative shares
    std::array<float, kRows * kColumns> column_end_{};  ///< cumulative shares inside the row
    std::array<float, kRows * kColumns> density_{};     ///< [1/sr]
  };
  /// The grid for a place in scene space; null if there is none or `normal` is zero.
  const Grid* at(Vec3 position, Vec3 normal) const;
  bool empty() const { return grids_.empty(); }

 private:
  struct Node {
    int axis = -1;  ///< -1: a leaf
    float split = 0;
    std::uint32_t left = 0, right = 0;  ///< child nodes; in a leaf `left` is the number of its grid, or kNoGrid
  };
  static constexpr std::uint32_t kNoGrid = 0xffffffff;
  struct Builder;
  std::vector<Node> nodes_;
  std::vector<Grid> grids_;
  std::array<std::uint32_t, 6> root_{};  ///< root node for each axis and sign of a normal
};

}  // namespace tempolux
