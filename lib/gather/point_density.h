// lib/gather/point_density.h -- irradiance from photons where walls, edges and steps cut the disc.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/density/photon_index.h"
#include "lib/gather/facing_grid.h"
#include "lib/irradcache/points.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Can light that falls on one place of a surface be taken for light at another near it?
class Reach {
 public:
  explicit Reach(const Tracer& tracer);

  /// Either nothing is between the two, or nothing is on the way across the tangent plane of `from` and down
  /// from there: the straight line cuts through a surface that bends away, the other way through one that
  /// bends up. Both ways run a little (2 offset()) above the surfaces, whose normals are
  /// unit and on the lit sides; that of `to` may be off by 1e-2.
  bool operator()(Vec3 from, Vec3 normal, Vec3 to, Vec3 to_normal) const;
  /// Is nothing between the two, which lie above surfaces?
  bool free(Vec3 from, Vec3 to) const;
  /// m: 2^-20 of the largest coordinate of the scene.
  float offset() const { return offset_; }

 private:
  const Tracer& tracer_;
  float offset_;
};

struct DensityOptions {
  int neighbours = 50;   ///< k
  float max_radius = 1;  ///< m
  int area_probes = 32;  ///< that must arrive where the disc is not whole
};

/// Density estimates over one set of photons. Thread-safe.
///
///     E = sum of flux over those of the k-1 nearest that can be reached / area that can be reached
///
/// nearest and area: in the ellipsoid 1 : 1/10 about the point that touches the k-th photon (or of
/// max_radius, with all its photons, if it holds fewer), on surfaces within 84 degrees of the point's plane.
/// Where light is uniform on what can be reached, whatever it is beyond, E has no bias: given the ellipsoid,
/// each of the k-1 photons is one with probability (light that can be reached / all light in it), and (k-1) /
/// (all light in it) has the mean 1 (irradiance_estimate.h). For that the same test (Reach) must decide on
/// photons and on area: clipping the area alone gains light at thin walls, dropping photons alone loses it in
/// corners (prototype.md 7).
class PointDensity {
 public:
  /// Of the photons of these kinds (kind_bit), moved by `shift` [m] into the scene's space.
  PointDensity(const Tracer& tracer, std::span<const formats::Photon> photons, const DensityOptions& options,
               std::uint8_t kinds = kAllKinds, Vec3d shift = {});

  /// No photon is of these kinds.
  bool empty() const { return index_.size() == 0; }

  /// Irradiance [W/m^2], >= 0; `radius` receives the half-axis of the ellipsoid, m, 0 if no photon is near.
  Rgb estimate(const IrradiancePoint& point, const PathRandom& random, float& radius) const;

  /// The same mean as estimate() at a fraction of the rays, for look-ups whose values are averaged over a pixel, and by
  /// the round kernel 2 (1 - (d/r)^2) [Epanechnikov 1969] in place of the flat one.
  ///
  /// Why round: (k-1) / (pi r_k^2) has the mean of the density where photons fall independently. Caustic photons do
  /// not: the mirror or lens keeps the even spread of Halton's sequence, where the k-th photon comes when k - 1/2 are
  /// to be expected, and the flat disc is dark by 1 / (2 k), 2 % at k = 25. A kernel that ends at 0 has the right mean
  /// in the one case and a third of that bias in the other; it is sharper (mean of d^2: r^2 / 3, not r^2 / 2) and in
  /// independent photons noisier, as if k were 3/4 k.
  ///
  /// Why cheaper: a few of the photons are tested, and all only if one of these cannot be reached; the area is that of
  /// few probes. No noise is added where the disc is whole. Exact in the mean: let u of the n photons be out of reach,
  /// m of them be tested first, and P = C(n-u, m) / C(n, m) be the chance to find none; where one is found, the flux is
  /// (reached - P all) / (1 - P), so that P all + (1 - P) that = reached.
  /// `radius`: as estimate(), but max_radius if no photon is near.
  Rgb estimate_sampled(Vec3 position, Vec3 normal, const PathRandom& random, float& radius) const;

  std::size_t photon_count() const { return index_.size(); }

 private:
  struct Disc {
    double radius = 0;          ///< m; 0: no photon is near
    std::size_t farthest = 0;   ///< of the photons found: not summed
  };
  enum class Kernel { flat, round };   ///< 1, or 2 (1 - d^2) at the share d of the radius
  Disc find(Vec3 position, Vec3 normal, NeighbourList& found) const;
  Rgb plain(Vec3 position, Vec3 normal, float& radius, NeighbourList& found) const;
  bool open_and_flat(const IrradiancePoint& point, float radius, float turn) const;
  double inverse_area(const IrradiancePoint& point, float radius, int probes, Kernel kernel,
                      const PathRandom& random) const;
  float column(const IrradiancePoint& point, Vec3 across, float height, float u) const;

  const Tracer& tracer_;
  DensityOptions options_;
  Reach reach_;
  PhotonIndex index_;
  FacingGrid facing_;
  std::vector<char> stores_;  ///< by material: has a Lambert lobe
};

}  // namespace tempolux
