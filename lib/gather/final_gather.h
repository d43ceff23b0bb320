// lib/gather/final_gather.h -- indirect irradiance at a place from gather rays over the hemisphere, with gradients.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/gather/gather_directions.h"
#include "lib/gather/incoming_radiance.h"
#include "lib/points/reachable_area.h"
#include "lib/irradcache/records.h"
#include "lib/trace/solid_around.h"

namespace tempolux {

struct GatherOptions {
  std::uint64_t seed = 0;
  int rays = 500;                        ///< of a record; rounded to M rings x N sectors with N about pi M
  const BrightPoints* bright = nullptr;  ///< points that are sampled explicitly; may be null (bright_points.h)
  int bright_samples = 100;              ///< explicit samples of a record
  /// True if records leave out the explicit part of the light of lamps close to surfaces, because pixels sample it
  /// themselves (KnownLight::lamp_spots).
  bool lamps_apart = false;
};

/// Gather rays from one place, at most one for each cell of the hemisphere, and the light that arrives along them.
struct GatherRays {
  std::vector<Ray> rays;
  std::vector<std::uint64_t> keys;   ///< of the random numbers at the rays' hits
  std::vector<std::uint32_t> cells;  ///< of the rays
  std::vector<Rgb> radiance;         ///< W/m^2/sr
  std::vector<float> distance;       ///< m; infinity: the ray meets nothing
  std::vector<RadianceSource> sources;

  void clear();
  /// Adds ray number `draw` of a cell. Returns false if the ray would start below the surface.
  bool aim(const GatherDirections& directions, std::uint32_t cell, std::uint32_t draw);
};

/// Gathers the indirect light that arrives at surface points. Thread-safe.
class FinalGather {
 public:
  FinalGather(const Tracer& tracer, const Lights& lights, const PointLookup& points, const GatherOptions& options);

  /// Gathers a record: the irradiance at `from` over the hemisphere around `normal` (unit, on the lit side), with its
  /// gradients. Sends about `rays` rays, one for each cell of equal weight (hemisphere.h). radius_unclamped is
  /// distance(); the caller computes the radius from it (limit_radius). Random numbers are keyed by position and
  /// normal, so a record does not depend on other records. `noise` is Hemisphere::noise, whose mean square is above the
  /// variance; place_records() measures by how much. ray_share in [1/8, 1]: the share of `rays` to send, rounded up to
  /// a power of two.
  IrradianceRecord gather(const SurfacePoint& from, Vec3 normal, GatherCounts& counts, float ray_share = 1) const;
  /// gather() without distance(): radius_unclamped is not set.
  IrradianceRecord light(const SurfacePoint& from, Vec3 normal, GatherCounts& counts, float ray_share = 1) const;
  /// Computes the light along the rays. If the surface has a coat, multiplies the light by Bsdf::arrival_weight, as for
  /// photons: a coat lets less light pass at grazing angles. The absorbing solid around `from` absorbs along the rays'
  /// first parts.
  void follow(const SurfacePoint& from, Vec3 normal, GatherRays& shot, GatherCounts& counts) const;
  /// R [m], the harmonic mean distance of the hits of cosine-distributed rays; infinite if all rays miss. Sends 64 rays
  /// at a time, at most 512, until 8 have met a surface; R then has a relative error of 1/3. These rays are independent
  /// of the gather rays. If they were the same, a record whose rays meet a small bright object by chance would get a
  /// smaller radius, and so less weight, than a record whose rays miss the object: interpolated light would be too
  /// dark.
  float distance(const SurfacePoint& from, Vec3 normal, GatherCounts& counts) const;
  /// A copy with other random numbers.
  FinalGather with_seed(std::uint64_t seed) const;
  std::uint64_t seed() const { return options_.seed; }
  /// Measures the clearance of a gathered record up to its radius; limit_radius() must have set the radius.
  void look_around(const SurfacePoint& from, IrradianceRecord& record) const;
  /// Adds the light of bright points to a record of gather rays, from GatherOptions::bright_samples explicit samples.
  /// `key`: place_key() of the record's place and normal, the key of the random numbers.
  void add_explicit(const SurfacePoint& from, std::uint64_t key, IrradianceRecord& record, GatherCounts& counts) const;

  /// Rays that distance() sends at a time; the harmonic mean of fewer distances is too uncertain for a radius.
  static constexpr int kDistanceRays = 64;

 private:
  static constexpr int kEnoughMet = 8;            ///< rays of distance() that must meet a surface
  static constexpr std::uint32_t kMostDraws = 8;  ///< times that distance() sends kDistanceRays

  const Tracer& tracer_;
  Reach reach_;
  SolidAround around_;
  IncomingRadiance incoming_;
  GatherOptions options_;
  /// The smallest ray_share is 2^-kFewer: one eighth of 500 rays is about kDistanceRays, which each record sends
  /// anyway, so a smaller share would hardly save time.
  static constexpr std::size_t kFewer = 3;
  std::array<GatherStrata, kFewer + 1> strata_;  ///< for 1/8, 1/4, 1/2 and 1 times `rays`
  const GatherStrata distance_strata_{kDistanceRays};
};

}  // namespace tempolux
