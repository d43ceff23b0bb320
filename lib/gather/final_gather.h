// lib/gather/final_gather.h -- one point's indirect irradiance by rays over the hemisphere, with gradients.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/gather/hemisphere.h"
#include "lib/gather/reachable_area.h"
#include "lib/irradcache/points.h"
#include "lib/irradcache/records.h"
#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct GatherOptions {
  std::uint64_t seed = 0;
  int rays = 500;                   ///< wanted where light is even; rounded to M rings x N_phi sectors, N_phi about pi M
  float near_factor = 2;            ///< hits nearer than about this many estimate radii continue one bounce
  bool curvature = false;           ///< also IrradianceRecord::curvature
};

/// near_hits: went on though a point stood for them; unanswered: went on as none did.
struct GatherCounts {
  std::uint64_t rays = 0, near_hits = 0, shadow_rays = 0, points_read = 0, unanswered = 0;
  GatherCounts& operator+=(const GatherCounts& o) {
    rays += o.rays; near_hits += o.near_hits; shadow_rays += o.shadow_rays; points_read += o.points_read; unanswered += o.unanswered;
    return *this;
  }
};

struct MediumPoint;   // lib/gather/medium_event.h

/// Gathers the light of kind indirect that arrives at surface points; media on the way take out and scatter. Thread-safe.
class FinalGather {
 public:
  FinalGather(const Tracer& tracer, const Lights& lights, const PointLookup& points, const GatherOptions& options);

  /// Irradiance at `from` over the hemisphere about `normal` (unit, on the lit side), with its gradients, by about
  /// `rays` cells of equal weight, one ray each and more where light is uneven (hemisphere.h). Where less than kEnoughLit of
  /// them is expected to carry the light, 2, 4 or 8 times as many, as it takes to make up for that: what a handful of rays
  /// finds is noise, and its radius depends on what was found. No bias comes of it as long as `expected_share` does not follow from
  /// this place's own rays: it is for the neighbours to tell, or for lit_share(). Under a coat light counts
  /// by Bsdf::arrival_weight, as photons do: what the coat reflects more of at grazing angles does not reach the Lambert
  /// lobe. radius_unclamped receives the harmonic mean distance, radius the distance across the tangent plane to the
  /// nearest of what the outermost ring met (limit_radius makes the validity of both). Random numbers come from the
  /// position: the record of a place does not depend on which records were made before, but for expected_share.
  IrradianceRecord gather(const SurfacePoint& from, Vec3 normal, GatherCounts& counts, float expected_share = 1) const;
  /// Sets the clearance of a record gathered there, as far as its radius: once that is limited.
  void look_around(const SurfacePoint& from, IrradianceRecord& record) const;
  /// Share of the hemisphere from which light comes (Hemisphere::lit_cells), by at most 64 rays that gather() does not use.
  float lit_share(const SurfacePoint& from, Vec3 normal, GatherCounts& counts) const;
  static constexpr float kEnoughLit = 1.0f / 16;

  /// Radiance arriving along rays that counts as indirect at their starts, and the distance to what each meets
  /// first (infinity: nothing). keys: random numbers, one for each ray. Fastest if rays that follow one another
  /// leave one place into like directions. All spans are of one length.
  void radiance(std::span<const Ray> rays, std::span<const std::uint64_t> keys, std::span<Rgb> radiance,
                std::span<float> distance, GatherCounts& counts) const;
  /// The order in which gather() follows the cells (numbers j N_phi + k): neighbours in it are neighbours on the
  /// hemisphere.
  std::span<const std::uint32_t> cell_order() const { return strata_.front().order; }

 private:
  struct Met;
  struct Strata {
    int rings = 0, sectors = 0;
    std::vector<std::uint32_t> order;   ///< of the cells
  };
  struct Shots;
  static Strata strata(int rays);
  struct Further;
  void meet(Vec3 wo, float distance, Met& met) const;
  template <class Take, class Key, class TakeMedium>
  void follow(std::span<const Ray> rays, bool alike, GatherCounts& counts, const Take& take, const Key& key, const TakeMedium& take_medium) const;
  Rgb scattered_in_media(const MediumPoint& at, const Further& from, GatherCounts& counts, std::vector<Further>& further) const;
  Rgb reflected(const Met& met, const PointLookup::Light* point, const Further& from, int depth, GatherCounts& counts,
                std::vector<Further>& further) const;
  Rgb reflected_beyond(const SurfacePoint& start, Vec3 travel, float distance, Further from, int depth, GatherCounts& counts,
                       std::vector<Further>& further, const MaterialValues* inside) const;
  Rgb scattered(const Met& met, const PointLookup::Light* point, const Further& from, Rgb scale, const PathRandom& random,
                int depth, GatherCounts& counts, std::vector<Further>& further) const;
  static float threshold(const PathRandom& random);
  bool is_near(const Met& met, const PointLookup::Light& point, const PathRandom& random) const;
  Rgb beside_edge(const Met& met, const PointLookup::Light& light, const PathRandom& random, GatherCounts& counts) const;
  Rgb sampled_light(const Met& met, const struct SeenSide& side, const PathRandom& random, GatherCounts& counts) const;

  const Tracer& tracer_;
  Reach reach_;
  const Lights& lights_;
  const PointLookup& points_;
  GatherOptions options_;
  std::array<Strata, 4> strata_;            ///< of 1, 2, 4 and 8 times `rays`
  Strata few_;                              ///< of lit_share()
  std::vector<std::array<Bsdf, 2>> bsdfs_;  ///< by material: seen from behind, from in front
};

}  // namespace tempolux
