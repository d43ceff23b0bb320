// lib/gather/hemisphere.h -- radiance and distances over a hemisphere: irradiance, how it changes, how far it holds.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/frame.h"
#include "lib/irradcache/records.h"

namespace tempolux {

/// Rings M and sectors N for about `rays` cells of equal weight, N about pi M.
void gather_strata(int rays, int& rings, int& sectors);

/// Incoming radiance in cells (j, k), number j N + k: ring j holds sin^2 of the angle from the normal in [j, j+1) / M,
/// sector k azimuths in [k, k+1) 2 pi / N. All cells contribute alike to the irradiance.
class Hemisphere {
 public:
  std::vector<Rgb> radiance;            ///< W/m^2/sr
  std::vector<float> inverse_distance;  ///< 1/m; 0: nothing there

  /// All cells dark and empty.
  void reset(int rings, int sectors);

  /// In the frame's space (z = normal):
  ///
  ///     E     = pi/(M N) sum L_jk
  ///     dE/dn = pi/(M N) sum_k v_k sum_j T_j L_jk                                      [Ward & Heckbert 1992]
  ///
  /// v_k at the middle of sector k + 90 degrees; T_j is the ring's mean of tan t (docs/methods/formulas.md: the sign is
  /// that of E(n) = E + (n_i x n) . dE/dn).
  void irradiance_and_rotational_gradient(const Frame& frame, IrradianceRecord& record) const;

  ///     dE/dx = sum_k { u_k 2pi/N sum_{j>=1} sin t_j- cos^2 t_j- / min(r_jk, r_j-1,k) (L_jk - L_j-1,k)
  ///                   + v_k- sum_j (sin t_j+ - sin t_j-) / min(r_jk, r_j,k-1) (L_jk - L_j,k-1) }
  ///
  /// u_k at the middle of sector k, v_k- at its lower edge + 90 degrees. To be asked for while each cell's radiance and
  /// distance are those of one ray: of a cell that an edge cuts a mean would have no distance.
  void translational_gradient(const Frame& frame, IrradianceRecord& record) const;

  /// How many more rays each cell deserves beside the one it has had: the standard deviation of the cells around it
  /// (eight, five at the rims) over the mean of all others, rounded, at most kMostFurther. More rays fall where light
  /// is uneven [Neyman 1934]. A cell's own ray has no say in it, so that the mean of that and the further ones has no
  /// bias: were bright rays themselves to call for more, dark ones would stay as they are and light would be lost.
  void further_rays(std::vector<std::uint8_t>& counts) const;
  static constexpr int kMostFurther = 8;

 private:
  std::size_t cell(int j, int k) const { return std::size_t(j) * std::size_t(sectors_) + std::size_t(k); }

  int rings_ = 0, sectors_ = 0;
  std::vector<double> ring_tangent_;  ///< T_j
};

}  // namespace tempolux
