// lib/points/footprint_density.h -- irradiance from photons that each light their own surroundings: total flux is kept.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lib/core/sampling.h"
#include "lib/density/box_tree.h"
#include "lib/density/photon_index.h"
#include "lib/density/photon_view.h"
#include "lib/points/reachable_area.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct FootprintOptions {
  int neighbours = 25;   ///< k, below kMaxNeighbours
  float max_radius = 0;  ///< m; 0: photon_reach()
  /// If more photons than this have footprints that cover a place, only this many are tested for reachability; 0: all
  /// are tested. They are drawn in proportion to their contribution. The estimate stays unbiased, and has no added
  /// noise where all photons or none reach the place. For estimates that a pixel averages.
  int asked = 0;
};

/// A surface that receives light. Normals are unit vectors on the lit side.
struct LitSurface {
  Vec3 geometric, smooth, shading;  ///< normal of the triangle; interpolated from its vertices; with the normal map
  const Bsdf* bsdf;                 ///< the Bsdf if the Lambert lobe may lie under a coat; null: no coat

  LitSurface(Vec3 geometric_normal, Vec3 smooth_normal, Vec3 shading_normal, const Bsdf* scattering = nullptr)
      : geometric(geometric_normal), smooth(smooth_normal), shading(shading_normal), bsdf(scattering) {}
  /// A surface without smooth normals and normal map.
  explicit LitSurface(Vec3 normal) : LitSurface(normal, normal, normal) {}
};

/// The share of a photon's flux that a normal map and a coat let through, for light from direction wi (unit) that
/// arrived at a triangle with this normal (unit, on the lit side):
///     R wi.n_shading / wi.normal x Bsdf::arrival_weight(R wi.n_shading)
/// R is the rotation from the photon's normal to at.smooth. So light has the same angle to the surface at the estimate
/// as at the photon, even if the surface bends between the two: without a map and a coat the share is 1, and no flux is
/// gained or lost. On a plane the share equals the factor in path tracing. 0 for light from behind the shading normal.
float received_share(Vec3 wi, Vec3 normal, const LitSurface& at);

/// Caustic light at a place.
struct FootprintLight {
  Rgb irradiance{0.0f};  ///< W/m^2; negative only if photons have negative flux
  Rgb noise{0.0f};       ///< W/m^2: the same sum with the signs of paths (path_signs.h)
  /// m: a distance within which light changes by a few per cent, because all footprints that reach there have radii of
  /// at least four times the distance. 0 if no footprint covers the place. Proof: the radii of two photons differ by at
  /// most the distance of the photons, because each reaches to its k-th neighbour. Let m be the maximum of r_i - d_i
  /// over the covering photons. Then each footprint that reaches within m / 9 of the place has a radius above 4 m / 9.
  float alike_within = 0;
};

/// Density estimate for light with edges and spots: caustics.
///
///     E(x) = sum over photons i that reach x of flux_i s_i K(d_i / r_i) / A_i,   K(t) = 2 (1 - t^2)  [Epanechnikov
///     1969]
///
/// - s_i: received_share at x (normal map and coat) if photons store directions, else 1.
/// - d_i [m]: distance between photon and x in the metric of an ellipsoid with the axes r_i, r_i and r_i / kFlattening.
/// - r_i [m]: distance to the photon's k-th neighbour, limited to the range from Reach::offset() to max_radius. It is
/// halved until enough of the ellipsoid is surface, which matters on wires.
/// - A_i [m^2]: area reachable from the photon, weighted by K. Reach decides for both area and x what is reachable.
///
/// The light of a photon is distributed over exactly the reachable surface. So the integral of E equals the flux, also
/// at walls, edges and steps. Footprints smaller than 64 Reach::offset(), in which float positions do not resolve
/// heights, count as whole discs.
///
/// The radius belongs to the photon and not to x [Breiman, Meisel & Purcell 1977]. The k nearest photons of x would
/// give too much light: their relative error is about r^2 / 8 times (Laplacian of E) / E, and r^2 is proportional to
/// 1 / E. The disc of each x around a spot would reach the spot, and only max_radius would bound the integral of the
/// estimates. For a disc of 1000 photons, 25 nearest photons give 8 to 12 % too much light, for 5000 photons 4 %. With
/// r_i in proportion to 1 / sqrt(E) at the photon, the error is of fourth order in r [Abramson 1982].
///
/// Stratified photons (a mirror keeps the stratification of Halton's sequence) and independent photons have the same
/// mean, so the formula has no k - 1 or k - 1/2. Thread-safe; same values for any number of threads.
class FootprintDensity {
 public:
  /// Uses the photons of these kinds (kind_bit), moved by `shift` [m] into scene space. `tracer` must outlive this
  /// object.
  FootprintDensity(const Tracer& tracer, const PhotonView& photons, const FootprintOptions& options,
                   std::uint8_t kinds = kAllKinds, Vec3d shift = {});

  /// True if no photon has one of these kinds.
  bool empty() const { return index_.size() == 0; }
  std::size_t photon_count() const { return index_.size(); }

  /// True if photons store directions, so that the shading normal of the surface matters.
  bool directed() const { return directed_; }
  /// The light at a place (m, scene space) on the lit side of a surface.
  FootprintLight estimate(Vec3 position, const LitSurface& surface) const;

 private:
  static constexpr std::size_t kLeaf = 32;
  struct alignas(64) Leaf {
    float x[kLeaf], y[kLeaf], z[kLeaf], nx[kLeaf], ny[kLeaf], nz[kLeaf];
    float inverse_r2[kLeaf];  ///< 1/m^2
    float flat[kLeaf];        ///< (radius / height)^2 - 1 of the ellipsoid
  };
  /// Radius and area of a footprint. Measured when the footprint is first needed, because most footprints never are.
  class Extent {
   public:
    Extent() = default;
    static Extent of_area(float radius, float inverse_area) { return {radius, inverse_area}; }
    /// The whole plane within the radius is reachable.
    static Extent of_whole_disc(float radius) { return {radius, -1 / (kPi * radius * radius)}; }
    bool known() const { return radius_ > 0; }
    float radius() const { return radius_; }                          ///< m
    float inverse_area() const { return std::abs(signed_inverse_); }  ///< 1/m^2, of the reachable area
    bool whole_disc() const { return signed_inverse_ < 0; }

   private:
    Extent(float radius, float signed_inverse) : radius_(radius), signed_inverse_(signed_inverse) {}
    float radius_ = 0;
    float signed_inverse_ = 0;  ///< negative: whole_disc(); an Extent has eight bytes, so that an atomic needs no lock
  };
  struct Covering {
    std::uint32_t photon;
    float distance2;  ///< m^2, in the metric of the ellipsoid
  };
  float radius_of(std::size_t photon, Vec3 normal, NeighbourList& found) const;
  void build_tree();
  struct Candidate;
  struct Sums;
  Sums of_asked(Vec3 position, Vec3 normal, std::span<const Candidate> candidates, double whole) const;
  void find_covering(Vec3 position, Vec3 normal, std::vector<Covering>& found) const;
  void scan_leaf(std::size_t leaf, Vec3 position, Vec3 normal, std::vector<Covering>& found) const;
  Extent extent_of(std::uint32_t photon) const;
  Extent measure(std::uint32_t photon) const;
  float outer_radius(std::uint32_t photon) const;
  Vec3 normal_of(std::uint32_t photon) const;

  FootprintOptions options_;
  ReachableArea area_;
  PhotonIndex index_;
  bool directed_ = false;
  std::vector<std::int8_t> signs_;   ///< path_signs()
  std::vector<Vec3> arriving_from_;  ///< wi in the order of the index, if directed
  std::unique_ptr<Leaf[]> leaves_;   ///< in the order of the index; unused places hold NaN, which covers no place
  BoxTree tree_;                     ///< over the boxes of footprints
  std::unique_ptr<std::atomic<Extent>[]> extents_;
};

}  // namespace tempolux
