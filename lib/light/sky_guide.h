// lib/light/sky_guide.h -- how much of the environment's light reaches places, and from where, learned from rays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// What places learn from rays about the environment: how much of its light arrives, and from which directions; and how
/// much of the light of lamps arrives. A ray that reaches the environment is a hit.
///
/// Places are divided by the axis that their normal is closest to, then at the median of their hits, along the longest
/// side of the box around the hits, while each half has kLeastHits. Each part holds the irradiance that its hits
/// estimate, and a grid of directions. The grid covers the box around the hits' directions in (height, azimuth) with
/// kRows x kColumns cells of equal solid angle. A cell is drawn by the weight of the hits in and around the cell, and
/// with a smaller probability uniformly; a direction inside the cell is drawn uniformly. A part has no grid if its
/// places see more than kMostSeen of the environment, because rays of pdf cos / pi then deviate by at most 300 % of
/// their mean; nor if it has fewer than kLeastHits hits. Derivation and measurements: docs/methods/lights.md.
class SkyGuide {
 public:
  struct Place {
    Vec3 position, normal;  ///< scene space, m; unit normal on the side that sends rays
    /// Square of the irradiance that a sample of the lights inside the scene brings, over the square of their
    /// unshadowed irradiance as the light tree estimates it. Below 0: not known.
    float lamps = -1;
  };
  struct Hit {
    std::uint32_t place = 0;  ///< index of the place that sent the ray
    Vec3 direction;           ///< unit, towards the environment
    float share = 1;          ///< cos / pi over the pdf of the ray
    float weight = 0;         ///< radiance [W/m^2/sr, largest channel] times share, above 0
  };
  /// Half and twice the numbers of kRows and kLeastHits: docs/notebook/constants.md.
  static constexpr int kRows = 16, kColumns = kRows;
  static constexpr std::size_t kLeastHits = 64;
  static constexpr double kMostSeen = 0.1;

  /// What a guide is for. light: to sample light; a quarter (kUnguidedShare) of a grid's density is uniform. search: to
  /// send more rays where few hits are known. A search has grids of fewer hits, on each side a quarter wider than the
  /// box around them, and half uniform, since few hits miss parts of a window.
  enum class Use : std::uint8_t { light, search };
  static constexpr std::size_t kSearchHits = 16;  ///< in place of kLeastHits

  SkyGuide() = default;
  /// Every place has sent `rays` rays. Hits must be in a fixed order; the guide then depends on nothing else.
  SkyGuide(std::span<const Place> places, std::vector<Hit> hits, int rays, Use use = Use::light);

  /// A piecewise constant pdf over a part of the sphere.
  class Grid {
   public:
    explicit Grid(std::span<const Hit> hits, Use use = Use::light);
    /// Draws a unit direction; u1 and u2 are in [0, 1).
    Vec3 sample(double u1, double u2) const;
    /// pdf [1/sr] with which sample() gives `direction` (unit).
    double pdf_solid_angle(Vec3 direction) const;

   private:
    double top_ = 1, height_ = 2, first_ = 0, turn_ = 0;  ///< the box: highest y, extent in y, first azimuth, extent
    std::array<float, kRows> row_end_{};                  ///< cumulative shares
    std::array<float, kRows * kColumns> column_end_{};    ///< cumulative shares inside the row
    std::array<float, kRows * kColumns> density_{};       ///< [1/sr]
  };
  /// What the places of a part have learned.
  struct Part {
    double irradiance = 0;  ///< that arrives from the environment [W/m^2, largest channel]; mean over the places
    double rms = 0;         ///< root mean square of estimates of `irradiance` by one sample of the grid; 0: no grid
    double lamps = 1;       ///< root of the mean of Place::lamps; 1: not known
    std::uint32_t grid = kNoGrid;
  };
  /// The part that holds a place in scene space; null if `normal` is zero or there are no parts.
  const Part* at(Vec3 position, Vec3 normal) const;
  /// The grid of a part; null if there is none, also for null.
  const Grid* grid_of(const Part* part) const { return part && part->grid != kNoGrid ? &grids_[part->grid] : nullptr; }
  bool has_grids() const { return !grids_.empty(); }

 private:
  struct Node {
    int axis = -1;  ///< -1: a leaf
    float split = 0;
    std::uint32_t left = 0, right = 0;  ///< child nodes; in a leaf `left` is the number of its part
  };
  static constexpr std::uint32_t kNoGrid = 0xffffffff;
  struct Builder;
  std::vector<Node> nodes_;
  std::vector<Part> parts_;
  std::vector<Grid> grids_;
  std::array<std::uint32_t, 6> root_{};  ///< root node for each axis and sign of a normal
};

}  // namespace tempolux
