#include "lib/gather/final_gather.h"

#include <algorithm>
#include <cmath>

#include "lib/gather/bright_points.h"
#include "lib/gather/gathered_record.h"
#include "lib/gather/hemisphere.h"

namespace tempolux {
namespace {

/// Rays from one place, and the radiance that arrives along them.
struct Shots {
  const GatherDirections directions;
  std::vector<Ray> rays;
  std::vector<std::uint64_t> keys;
  std::vector<std::uint32_t> cells;  ///< cell of each ray
  std::vector<Rgb> radiance;
  std::vector<float> distance;
  std::vector<RadianceSource> sources;

  Shots(const SurfacePoint& from, Vec3 normal, const GatherStrata& strata, std::uint64_t seed)
      : directions(from, normal, strata.rings, strata.sectors, gather_key(from.position, normal, seed)) {}

  void clear() {
    rays.clear();
    keys.clear();
    cells.clear();
  }
  /// Adds the sample-th ray of a cell, if that ray starts above the surface.
  void aim(std::uint32_t cell, std::uint32_t sample) {
    Ray ray;
    std::uint64_t key = 0;
    if (!directions.aim(cell, sample, ray, key)) return;
    rays.push_back(ray);
    keys.push_back(key);
    cells.push_back(cell);
  }
  void shoot(const IncomingRadiance& incoming, GatherCounts& counts) {
    radiance.resize(rays.size());
    distance.resize(rays.size());
    sources.resize(rays.size());
    incoming(rays, keys, radiance, distance, counts, sources);
  }
};

}  // namespace

FinalGather::FinalGather(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                         const GatherOptions& options)
    : tracer_(tracer), reach_(tracer), incoming_(tracer, lights, points, options.bright), options_(options) {
  for (std::size_t i = 0; i < strata_.size(); ++i)
    strata_[i] = GatherStrata(std::max(1, int((std::int64_t(options.rays) << i) >> kFewer)));
}

FinalGather FinalGather::with_seed(std::uint64_t seed) const {
  FinalGather other(*this);
  other.options_.seed = seed;
  return other;
}

void FinalGather::look_around(const SurfacePoint& from, IrradianceRecord& record) const {
  const Vec3 lit = dot(from.normal_geometric, record.normal) < 0 ? -from.normal_geometric : from.normal_geometric;
  record.clearance = reach_.clearance(from.position, lit, record.normal, record.radius * Clearance::kPerRadius);
}

float FinalGather::distance(const SurfacePoint& from, Vec3 normal, GatherCounts& counts) const {
  const GatherStrata& strata = distance_strata_;
  const GatherDirections directions(from, normal, strata.rings, strata.sectors,
                                    gather_key(from.position, normal, ~options_.seed));
  const float closest = closest_distance(from);
  thread_local std::vector<Ray> rays;
  thread_local std::vector<Hit> hits;
  double met = 0, inverse = 0;
  for (std::uint32_t draw = 0; draw < kMostDraws && met < kEnoughMet; ++draw) {
    rays.clear();
    for (const std::uint32_t c : strata.order) {
      Ray ray;
      std::uint64_t key = 0;
      if (directions.aim(c, draw, ray, key)) rays.push_back(ray);
    }
    hits.assign(rays.size(), Hit{});
    tracer_.intersect(rays, hits);
    counts.distance_rays += rays.size();
    for (const Hit& hit : hits)
      if (hit.surface != kNone) ++met, inverse += 1 / double(std::max(hit.t, closest));
  }
  return met > 0 ? float(met / inverse) : INFINITY;
}

IrradianceRecord FinalGather::gather(const SurfacePoint& from, Vec3 normal, GatherCounts& counts,
                                     float ray_share) const {
  thread_local Hemisphere sky;
  thread_local std::vector<std::uint8_t> further;
  thread_local std::vector<Rgb> noise;  // by cell, of points
  std::size_t halvings = 0;
  for (; halvings < kFewer && ray_share <= 0.5f; ++halvings) ray_share *= 2;
  const GatherStrata& strata = strata_[kFewer - halvings];
  const std::vector<std::uint32_t>& order = strata.order;
  Shots shots(from, normal, strata, options_.seed);
  sky.reset(strata.rings, strata.sectors);
  const float closest = closest_distance(from);
  const Bsdf bsdf = incoming_.bsdf_at(from, normal);
  const bool coated = bsdf.has_specular() && bsdf.has_diffuse();
  const auto shoot = [&] {
    shots.shoot(incoming_, counts);
    if (coated)
      for (std::size_t i = 0; i < shots.rays.size(); ++i) {
        const float weight = bsdf.arrival_weight(dot(shots.rays[i].direction, normal));
        shots.radiance[i] *= weight, shots.sources[i].noise *= weight;
      }
  };

  for (const std::uint32_t c : order) shots.aim(c, 0);
  shoot();
  noise.assign(sky.radiance.size(), Rgb(0.0f));
  for (std::size_t i = 0; i < shots.rays.size(); ++i) {
    sky.radiance[shots.cells[i]] = shots.radiance[i];
    noise[shots.cells[i]] = shots.sources[i].noise;
    sky.inverse_distance[shots.cells[i]] = 1 / std::max(shots.distance[i], closest);  // 0 if the ray meets nothing
  }
  IrradianceRecord record = record_of_first_rays(sky, shots.directions.frame(), from, normal);
  record.radius_unclamped = distance(from, normal, counts);

  // Sends further rays where light varies. The value of a cell becomes the mean over all of its rays.
  sky.further_rays(further);
  shots.clear();
  for (const std::uint32_t c : order)
    for (std::uint32_t sample = 1; sample <= further[c]; ++sample) shots.aim(c, sample);
  shoot();
  for (std::size_t c = 0; c < further.size(); ++c)
    if (further[c] > 0) sky.radiance[c] *= 1 / float(1 + further[c]), noise[c] *= 1 / float(1 + further[c]);
  for (std::size_t i = 0; i < shots.rays.size(); ++i) {
    const std::uint32_t c = shots.cells[i];
    sky.radiance[c] += shots.radiance[i] * (1 / float(1 + further[c]));
    noise[c] += shots.sources[i].noise * (1 / float(1 + further[c]));
  }
  sky.irradiance_and_rotational_gradient(shots.directions.frame(), record);
  const std::uint64_t key = gather_key(from.position, normal, options_.seed);
  record.noise = sky.noise(key);
  for (const Rgb of_cell : noise) record.points_noise += of_cell * (kPi / float(noise.size()));
  add_explicit(from, key, record, counts);
  return record;
}

void FinalGather::add_explicit(const SurfacePoint& from, std::uint64_t key, IrradianceRecord& record,
                               GatherCounts& counts) const {
  if (!options_.bright) return;
  const Bsdf bsdf = incoming_.bsdf_at(from, record.normal);
  const bool coated = bsdf.has_specular() && bsdf.has_diffuse();
  const PathRandom random(options_.seed ^ 0x6272696768740001ull, key);
  add_bright_light(options_.bright->arriving({from, record.normal, coated ? &bsdf : nullptr}, options_.bright_samples,
                                             random, counts),
                   record);
}

}  // namespace tempolux
