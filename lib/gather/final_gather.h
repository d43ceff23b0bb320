// lib/gather/final_gather.h -- indirect irradiance at a place from gather rays over the hemisphere, with gradients.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/gather/gather_directions.h"
#include "lib/gather/incoming_radiance.h"
#include "lib/gather/reachable_area.h"
#include "lib/irradcache/records.h"
#include "lib/trace/solid_around.h"

namespace tempolux {

struct GatherOptions {
  std::uint64_t seed = 0;
  /// Number of rays; rounded to M rings x N_phi sectors with N_phi about pi M.
  int rays = 500;
  const BrightPoints* bright = nullptr;  ///< points that are sampled explicitly, if any (bright_points.h)
  int bright_samples = 100;              ///< explicit samples per record
  /// Records leave out the explicit part of the light of lamps close to surfaces, for pixels that sample it themselves
  /// (KnownLight::lamp_spots).
  bool lamps_apart = false;
};

/// Rays from one place, at most one through each cell, and what arrives along them.
struct GatherRays {
  std::vector<Ray> rays;
  std::vector<std::uint64_t> keys;  ///< of the random numbers at their hits
  std::vector<std::uint32_t> cells;
  std::vector<Rgb> radiance;    ///< W/m^2/sr
  std::vector<float> distance;  ///< m; infinity: the ray meets nothing
  std::vector<RadianceSource> sources;

  void clear();
  /// Adds the draw-th ray of a cell. False if that ray would start below the surface.
  bool aim(const GatherDirections& directions, std::uint32_t cell, std::uint32_t draw);
};

/// Gathers the indirect light that arrives at surface points. Thread-safe.
class FinalGather {
 public:
  FinalGather(const Tracer& tracer, const Lights& lights, const PointLookup& points, const GatherOptions& options);

  /// Irradiance at `from` over the hemisphere around `normal` (unit, on the lit side), with its gradients. Sends about
  /// `rays` rays, one through each cell of equal weight (hemisphere.h). radius_unclamped receives distance();
  /// limit_radius computes the radius from it. Random numbers are keyed by the position, so a record does not depend on
  /// other records. `noise` is Hemisphere::noise, whose mean square is above the variance: place_records() measures by
  /// how much. ray_share in [1/8, 1]: the share of `rays` that the place needs, rounded up to a power of two.
  IrradianceRecord gather(const SurfacePoint& from, Vec3 normal, GatherCounts& counts, float ray_share = 1) const;
  /// Computes the light along the rays. Below a coat, light is weighted by Bsdf::arrival_weight, as photons are: the
  /// coat reflects more of it at grazing angles. The absorbing solid around `from` absorbs along the rays' first parts.
  void follow(const SurfacePoint& from, Vec3 normal, GatherRays& shot, GatherCounts& counts) const;
  /// R [m], the harmonic mean distance of hits of cosine-distributed rays; infinite if all rays miss. Sends 64 rays,
  /// and 64 more at a time up to 512 until 8 have hit something; R then has a relative error of 1/3. These rays are
  /// independent of those that estimate light. If both were the same rays, a record whose rays happen to meet a small
  /// bright object would get a smaller radius and so less weight than a record that misses it, and the interpolated
  /// light would be too dark.
  float distance(const SurfacePoint& from, Vec3 normal, GatherCounts& counts) const;
  /// The same gathering with other random numbers.
  FinalGather with_seed(std::uint64_t seed) const;
  std::uint64_t seed() const { return options_.seed; }
  /// Sets the clearance of a gathered record up to its radius; call after limit_radius.
  void look_around(const SurfacePoint& from, IrradianceRecord& record) const;
  /// Adds GatherOptions::bright_samples explicit samples to a record of gather rays, if there are bright points. Random
  /// numbers are keyed by `key` = gather_key() of the record's place and normal.
  void add_explicit(const SurfacePoint& from, std::uint64_t key, IrradianceRecord& record, GatherCounts& counts) const;

  /// Rays of distance(): the harmonic mean of fewer distances does not determine a record's radius.
  static constexpr int kDistanceRays = 64;

 private:
  static constexpr int kEnoughMet = 8;
  static constexpr std::uint32_t kMostDraws = 8;

  const Tracer& tracer_;
  Reach reach_;
  SolidAround around_;
  IncomingRadiance incoming_;
  GatherOptions options_;
  static constexpr std::size_t kFewer = 3;
  std::array<GatherStrata, kFewer + 1> strata_;  ///< for 1/8, 1/4, 1/2 and 1 times `rays`
  const GatherStrata distance_strata_{kDistanceRays};
};

}  // namespace tempolux
