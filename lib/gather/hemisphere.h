// lib/gather/hemisphere.h -- radiance and distances over a hemisphere: irradiance and its gradients.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lib/core/frame.h"
#include "lib/irradcache/records.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Incoming radiance in cells (j, k) with index j N + k. Ring j holds sin^2 of the angle to the normal in [j, j+1) / M;
/// sector k holds azimuths in [k, k+1) 2 pi / N. All cells contribute equally to the irradiance.
class Hemisphere {
 public:
  std::vector<Rgb> radiance;            ///< W/m^2/sr
  std::vector<float> inverse_distance;  ///< 1/m; 0: no surface in this direction

  /// Makes all cells dark and empty.
  void reset(int rings, int sectors);

  /// The record of a place with irradiance and gradients, without radii. `normal`: unit, on the lit side, the axis of
  /// the hemisphere.
  IrradianceRecord record(const SurfacePoint& place, Vec3 normal) const;

  /// A number with a random sign whose mean square is at least the variance of the irradiance [W/m^2]:
  ///
  ///     pi/(M N) sum_p s_p (L_2p - L_2p+1),   s_p = -1 or 1 at random,
  ///
  /// over pairs p of cells with successive indices. Its mean square is the variance of the irradiance plus (pi/(M
  /// N))^2 times the squared differences of the light that arrives in the two cells of each pair. `key`: of the
  /// random signs.
  Rgb noise(std::uint64_t key) const;

 private:
  /// Sets irradiance and rotational gradient of the record. In the frame's space (z = normal):
  ///
  ///     E     = pi/(M N) sum L_jk
  ///     dE/dn = pi/(M N) sum_k v_k sum_j T_j L_jk                                      [Ward & Heckbert 1992]
  ///
  /// v_k: tangent at the middle of sector k + 90 degrees. T_j: mean of tan t over ring j (docs/methods/formulas.md; the
  /// sign is such that E(n) = E + (n_i x n) . dE/dn).
  void irradiance_and_rotational_gradient(const Frame& frame, IrradianceRecord& record) const;

  /// Sets the translational gradient of the record:
  ///
  ///     dE/dx = sum_k { u_k 2pi/N sum_{j>=1} sin t_j- cos^2 t_j- / min(r_jk, r_j-1,k) (L_jk - L_j-1,k)
  ///                   + v_k- sum_j (sin t_j+ - sin t_j-) / min(r_jk, r_j,k-1) (L_jk - L_j,k-1) }
  ///
  /// u_k: tangent at the middle of sector k. v_k-: tangent at its lower edge + 90 degrees.
  void translational_gradient(const Frame& frame, IrradianceRecord& record) const;
  std::size_t cell(int j, int k) const { return std::size_t(j) * std::size_t(sectors_) + std::size_t(k); }

  int rings_ = 0, sectors_ = 0;
  std::vector<double> ring_tangent_;  ///< T_j
};

/// m: smallest distance from a place that is used, so that 1 / distance stays finite.
inline float closest_distance(const SurfacePoint& place) { return std::max(4 * place.offset, 1e-30f); }

}  // namespace tempolux
