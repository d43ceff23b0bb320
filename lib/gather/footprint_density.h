// lib/gather/footprint_density.h -- irradiance from photons each of which lights its own surroundings: nothing is
// gained or lost.
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
#include "lib/gather/reachable_area.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct FootprintOptions {
  int neighbours = 25;   ///< k, below kMaxNeighbours
  float max_radius = 0;  ///< m; 0: the photons' own (photon_reach): one in twenty is so far from others
  /// Of the photons whose footprints cover a place so many are asked whether they reach it, drawn by what they would
  /// give; 0: all. No bias, and no noise where all reach it or none: for estimates of which a pixel averages several.
  int asked = 0;
  float margin =
      0;  ///< of max_radius: light counts as smooth only if no footprint narrower than that is as near as this
};

/// What light falls on. Normals are unit, on the lit side.
struct LitSurface {
  Vec3 geometric, smooth, shading;  ///< of the triangle; of its vertices; of a normal map
  const Bsdf* bsdf;                 ///< how it scatters, as the Lambert lobe may lie under a coat; null: it does not

  LitSurface(Vec3 geometric_normal, Vec3 smooth_normal, Vec3 shading_normal, const Bsdf* scattering = nullptr)
      : geometric(geometric_normal), smooth(smooth_normal), shading(shading_normal), bsdf(scattering) {}
  /// A surface that is what its triangles are.
  explicit LitSurface(Vec3 normal) : LitSurface(normal, normal, normal) {}
};

/// What a normal map and a coat make of a photon's flux, as a share of it: light came from wi (unit) to a triangle of
/// this normal.
///     R wi.n_shading / wi.normal x Bsdf::arrival_weight(R wi.n_shading)
/// R: the turn from the photon's normal to n_smooth, so that light meets the surface that it is counted for as it met
/// its own, however that bends on the way: without a map and a coat the share is 1, and nothing is gained or lost. On a
/// plane it is what path tracing has. 0 from behind the shading normal.
float received_share(Vec3 wi, Vec3 normal, const LitSurface& at);

/// Density of light that has edges and spots: caustics.
///
///     E(x) = sum over photons i that reach x of flux_i s_i K(d_i / r_i) / A_i,   K(t) = 2 (1 - t^2)  [Epanechnikov
///     1969]
///
/// s_i: received_share of x if the photons have directions, by the normal map and the coat of x; 1 if not.
/// d_i: distance from the photon in the metric of the ellipsoid r_i : r_i : r_i / kFlattening about it. r_i [m]: to its
/// k-th neighbour, at most max_radius; at least Reach::offset(), and halved while hardly any of the ellipsoid is
/// surface (on wires). A_i [m^2]: the area that can be reached from it (Reach, which also decides on x), weighted by K.
/// So each photon's light is spread over surface, all of it and no more: the integral of E is the flux, at walls, edges
/// and steps too. Only of footprints so small that positions cannot tell heights in them (64 Reach::offset()) nothing
/// is asked, they count as discs.
///
/// Why the radius is the photon's and not x's [Breiman, Meisel & Purcell 1977]: the k nearest of x give more light than
/// there is. Their relative error is about r^2 / 8 times (Laplacian of E) / E, and r^2 goes as 1 / E: around a spot
/// each x reaches as far as the spot is, and the integral of what they find there, k / (pi d^2), has no bound but
/// max_radius. Of a disc of 1000 photons 25 nearest make 8 to 12 % more, of 5000 4 %. With r_i as 1 / sqrt(E) at the
/// photon the error is of the fourth order in r [Abramson 1982].
///
/// Evenly spread photons (a mirror keeps the even spread of Halton's sequence) and independent ones have the same mean:
/// no k - 1 or k - 1/2 is in it. Thread-safe; the same values for any number of threads.
class FootprintDensity {
 public:
  /// Of the photons of these kinds (kind_bit), moved by `shift` [m] into the scene's space.
  FootprintDensity(const Tracer& tracer, const PhotonView& photons, const FootprintOptions& options,
                   std::uint8_t kinds = kAllKinds, Vec3d shift = {});

  /// No photon is of these kinds.
  bool empty() const { return index_.size() == 0; }
  std::size_t photon_count() const { return index_.size(); }

  /// Do photons have directions: does it matter how the surface bends its normals?
  bool directed() const { return directed_; }
  /// Irradiance [W/m^2] of a place above a surface's lit side. Below 0 only by photons of negative flux.
  /// `smooth_over`: max_radius where footprints cover the place and all that come within `margin` are as wide as that;
  /// else 0.
  Rgb estimate(Vec3 position, const LitSurface& surface, float& smooth_over) const;
  /// The same. `alike_within`: so far from here [m] no footprint lies that is narrower than four times that, so that
  /// light changes by a few per cent; 0 where none covers the place. A photon's radius differs from a near one's by
  /// their distance at most (both reach to a k-th neighbour): with m = max over covering photons (r_i - d_i) what
  /// reaches to m / 9 from here is wider than m 4 / 9.
  Rgb estimate_around(Vec3 position, const LitSurface& surface, float& alike_within) const;
  /// Of a surface without bent normals or a coat.
  Rgb estimate(Vec3 position, Vec3 normal, float& smooth_over) const {
    return estimate(position, LitSurface(normal), smooth_over);
  }

 private:
  static constexpr std::size_t kLeaf = 32;
  struct alignas(64) Leaf {
    float x[kLeaf], y[kLeaf], z[kLeaf], nx[kLeaf], ny[kLeaf], nz[kLeaf];
    float inverse_r2[kLeaf];  ///< 1/m^2
    float flat[kLeaf];        ///< (radius / height)^2 - 1 of the ellipsoid
    float narrow2[kLeaf];     ///< m^2: (radius + margin)^2 of those narrower than max_radius, else -1
  };
  /// Found when a footprint is first asked for: most of a map's are never seen.
  class Extent {
   public:
    Extent() = default;
    static Extent of_area(float radius, float inverse_area) { return {radius, inverse_area}; }
    /// All of the plane within the radius can be reached.
    static Extent of_whole_disc(float radius) { return {radius, -1 / (kPi * radius * radius)}; }
    bool known() const { return radius_ > 0; }
    float radius() const { return radius_; }                          ///< m
    float inverse_area() const { return std::abs(signed_inverse_); }  ///< 1/m^2, of what can be reached
    bool whole_disc() const { return signed_inverse_ < 0; }

   private:
    Extent(float radius, float signed_inverse) : radius_(radius), signed_inverse_(signed_inverse) {}
    float radius_ = 0,
          signed_inverse_ = 0;  ///< eight bytes, so that an atomic one needs no lock; the sign says whole_disc()
  };
  struct Covering {
    std::uint32_t photon;
    float distance2;  ///< m^2, in the ellipsoid's metric
  };
  float radius_of(std::size_t photon, Vec3 normal, NeighbourList& found) const;
  void build_tree();
  struct Candidate;
  struct Extents;
  Rgb estimate(Vec3 position, const LitSurface& surface, Extents& extents) const;
  Rgbd of_asked(Vec3 position, Vec3 normal, std::span<const Candidate> candidates, double whole) const;
  bool find_covering(Vec3 position, Vec3 normal, std::vector<Covering>& found) const;
  bool scan_leaf(std::size_t leaf, Vec3 position, Vec3 normal, std::vector<Covering>& found) const;
  Extent extent_of(std::uint32_t photon) const;
  Extent measure(std::uint32_t photon) const;
  bool leaf_whole(std::size_t leaf) const;
  bool measure_leaf(std::size_t leaf) const;
  float outer_radius(std::uint32_t photon) const;
  Vec3 normal_of(std::uint32_t photon) const;

  FootprintOptions options_;
  ReachableArea area_;
  PhotonIndex index_;
  bool directed_ = false;
  std::vector<Vec3> arriving_from_;  ///< wi in the index's order, if directed
  std::unique_ptr<Leaf[]> leaves_;   ///< in the index's order; unused places hold NaN, which covers nothing
  BoxTree tree_;                     ///< of footprints' boxes with their margins
  std::unique_ptr<std::atomic<Extent>[]> extents_;
  std::unique_ptr<std::atomic<std::uint8_t>[]> leaf_whole_;
};

}  // namespace tempolux
