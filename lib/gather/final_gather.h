// lib/gather/final_gather.h -- one point's indirect irradiance by rays over the hemisphere, with gradients.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/gather/gather_directions.h"
#include "lib/gather/incoming_radiance.h"
#include "lib/gather/reachable_area.h"
#include "lib/irradcache/records.h"

namespace tempolux {

struct GatherOptions {
  std::uint64_t seed = 0;
  int rays = 500;  ///< wanted where light is even; rounded to M rings x N_phi sectors, N_phi about pi M
  float near_factor = PointLookup::kNear;  ///< radii below which a hit is near
  const BrightPoints* bright = nullptr;    ///< points that are sampled explicitly, if any (bright_points.h)
  int bright_samples = 100;                ///< explicit samples of a record
};

/// Gathers the light of kind indirect that arrives at surface points. Thread-safe.
class FinalGather {
 public:
  FinalGather(const Tracer& tracer, const Lights& lights, const PointLookup& points, const GatherOptions& options);

  /// Irradiance at `from` over the hemisphere about `normal` (unit, on the lit side), with its gradients, by about
  /// `rays` cells of equal weight, one ray each and more where light is uneven (hemisphere.h). Under a coat light
  /// counts by Bsdf::arrival_weight, as photons do: what the coat reflects more of at grazing angles does not reach the
  /// Lambert lobe. radius_unclamped receives distance(); limit_radius makes the radius of it. Random numbers come
  /// from the position: the record of a place does not depend on which records were made before.
  /// ray_share: of `rays` that the place needs, 1/8 to 1; the next power of two that is not less.
  IrradianceRecord gather(const SurfacePoint& from, Vec3 normal, GatherCounts& counts, float ray_share = 1) const;
  /// R [m], the harmonic mean distance to what rays over the hemisphere meet, drawn by the cosine; infinite where they
  /// meet nothing. 64 rays are sent, and 64 more up to 512 until 8 have met something, which leaves R an error of 1/3.
  /// They are others than those that bring light: were they the same, records that happen to meet a small bright thing
  /// would reach less far than records that miss it, so weigh less, and their mean would be dark.
  float distance(const SurfacePoint& from, Vec3 normal, GatherCounts& counts) const;
  /// Sets the clearance of a record gathered there, as far as its radius: once that is limited.
  void look_around(const SurfacePoint& from, IrradianceRecord& record) const;
  /// Adds to a record of rays alone what GatherOptions::bright_samples explicit samples bring, if there are bright
  /// points. Random numbers are those of `key`, which gather_key() of the record's place and normal is.
  void add_explicit(const SurfacePoint& from, std::uint64_t key, IrradianceRecord& record, GatherCounts& counts) const;

  /// What rays bring.
  const IncomingRadiance& incoming() const { return incoming_; }
  /// The order in which gather() follows the cells (numbers j N_phi + k).
  std::span<const std::uint32_t> cell_order() const { return strata_[kFewer].order; }

 private:
  static constexpr int kDistanceRays = 64, kEnoughMet = 8;
  static constexpr std::uint32_t kMostDraws = 8;

  const Tracer& tracer_;
  Reach reach_;
  IncomingRadiance incoming_;
  GatherOptions options_;
  static constexpr std::size_t kFewer = 3;
  std::array<GatherStrata, kFewer + 1> strata_;  ///< of 1/8, 1/4, 1/2 and 1 times `rays`
  const GatherStrata distance_strata_{kDistanceRays};
};

}  // namespace tempolux
