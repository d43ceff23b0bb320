// lib/gather/facing_grid.h -- which way photons face, by place: tells points that can see none at once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/density/photon_index.h"

namespace tempolux {

/// A grid over the photons; each cell knows the directions of the normals in it and in the cells around it.
/// Half of all points lie on the outside of closed rooms: photons are near, but all face away.
class FacingGrid {
 public:
  /// max_radius: m, > 0, of the questions to come.
  FacingGrid(const PhotonIndex& photons, float max_radius);

  /// False only if no photon within max_radius of `point` has dot(normal of the photon, normal) > min_cos.
  /// May be true without one.
  bool any_near(Vec3 point, Vec3 normal, float min_cos) const;

 private:
  static constexpr std::uint32_t kBins = 32;  ///< per octahedral coordinate
  using Directions = std::array<std::uint64_t, kBins * kBins / 64>;
  static std::uint32_t bin_of(Vec3 normal);
  void spread(std::size_t stride, std::size_t count);

  Vec3 lower_;
  float inverse_cell_ = 0;
  std::array<std::size_t, 3> size_{};
  std::vector<Directions> cells_;
  std::vector<Vec3> bin_middle_;         ///< unit
  float bin_sine_ = 0, bin_cosine_ = 1;  ///< of the largest angle between a bin's middle and its corners
};

}  // namespace tempolux
