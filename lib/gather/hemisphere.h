// lib/gather/hemisphere.h -- irradiance and its gradients from radiance and distances over a hemisphere.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lib/core/frame.h"
#include "lib/irradcache/records.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Incoming radiance in the cells of GatherStrata with M rings and N sectors; cell (j, k) has the index j N + k. All
/// cells contribute equally to the irradiance.
class Hemisphere {
 public:
  std::vector<Rgb> radiance;            ///< W/m^2/sr
  std::vector<float> inverse_distance;  ///< 1/m; 0: no surface in this direction

  /// Makes all cells dark and empty.
  void reset(int rings, int sectors);

  /// A record at `place` with irradiance and gradients, without radii. `normal`: unit, on the lit side, the axis of the
  /// hemisphere.
  IrradianceRecord record(const SurfacePoint& place, Vec3 normal) const;

  /// A number with a random sign whose mean square is at least the variance of the irradiance [W/m^2]:
  ///
  ///     pi/(M N) sum_p s_p (L_2p - L_2p+1),   s_p = -1 or 1 at random,
  ///
  /// over pairs p of cells with successive indices. Its mean square is the variance of the irradiance, plus (pi/(M
  /// N))^2 times the sum over pairs of the squared difference between the expected radiances of the two cells. `key`:
  /// of the random signs.
  Rgb noise(std::uint64_t key) const;

 private:
  /// Sets irradiance and rotational gradient of the record. In the frame's space (z = normal):
  ///
  ///     E     = pi/(M N) sum L_jk
  ///     dE/dn = pi/(M N) sum_k v_k sum_j T_j L_jk                                      [Ward & Heckbert 1992]
  ///
  /// v_k: unit tangent 90 degrees after the middle of sector k. T_j: mean of tan t over ring j, where t is the angle to
  /// the normal (docs/methods/formulas.md). The sign is such that E(n) = E + (n_i x n) . dE/dn.
  void irradiance_and_rotational_gradient(const Frame& frame, IrradianceRecord& record) const;

  /// Sets the translational gradient of the record:
  ///
  ///     dE/dx = sum_k { u_k 2pi/N sum_{j>=1} sin t_j- cos^2 t_j- / min(r_jk, r_j-1,k) (L_jk - L_j-1,k)
  ///                   + v_k- sum_j (sin t_j+ - sin t_j-) / min(r_jk, r_j,k-1) (L_jk - L_j,k-1) }
  ///
  /// u_k: unit tangent at the middle of sector k. v_k-: unit tangent 90 degrees after the sector's lower edge. t_j- and
  /// t_j+: angles of the lower and the upper edge of ring j. r: distances of the hits [Ward & Heckbert 1992].
  void translational_gradient(const Frame& frame, IrradianceRecord& record) const;
  std::size_t cell(int j, int k) const { return std::size_t(j) * std::size_t(sectors_) + std::size_t(k); }

  int rings_ = 0, sectors_ = 0;
  std::vector<double> ring_tangent_;  ///< T_j
};

/// m: distances from a place count as at least this, so that 1 / distance stays finite.
inline float closest_distance(const SurfacePoint& place) { return std::max(4 * place.offset, 1e-30f); }

}  // namespace tempolux
