#include "lib/gather/final_gather.h"

#include <algorithm>
#include <cmath>

#include "lib/gather/bright_points.h"
#include "lib/gather/hemisphere.h"
#include "lib/material/inside.h"
#include "lib/material/seen_side.h"

namespace tempolux {

void GatherRays::clear() {
  rays.clear();
  keys.clear();
  cells.clear();
}

bool GatherRays::aim(const GatherDirections& directions, std::uint32_t cell, std::uint32_t draw) {
  Ray ray;
  std::uint64_t key = 0;
  if (!directions.aim(cell, draw, ray, key)) return false;
  rays.push_back(ray);
  keys.push_back(key);
  cells.push_back(cell);
  return true;
}

FinalGather::FinalGather(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                         const GatherOptions& options)
    : tracer_(tracer),
      reach_(tracer),
      around_(tracer),
      incoming_(tracer, lights, points, options.bright),
      options_(options) {
  for (std::size_t i = 0; i < strata_.size(); ++i)
    strata_[i] = GatherStrata(std::max(1, int((std::int64_t(options.rays) << i) >> kFewer)));
}

FinalGather FinalGather::with_seed(std::uint64_t seed) const {
  FinalGather other(*this);
  other.options_.seed = seed;
  return other;
}

void FinalGather::look_around(const SurfacePoint& from, IrradianceRecord& record) const {
  const Vec3 lit = face_forward(from.normal_geometric, record.normal);
  record.clearance = reach_.clearance(from.position, lit, record.normal, record.radius * Clearance::kPerRadius);
}

float FinalGather::distance(const SurfacePoint& from, Vec3 normal, GatherCounts& counts) const {
  const GatherStrata& strata = distance_strata_;
  const GatherDirections directions(from, normal, strata.rings, strata.sectors,
                                    place_key(from.position, normal, ~options_.seed));
  const float closest = closest_distance(from);
  thread_local GatherRays shot;
  thread_local std::vector<Hit> hits;
  double met = 0, inverse = 0;
  for (std::uint32_t draw = 0; draw < kMostDraws && met < kEnoughMet; ++draw) {
    shot.clear();
    for (const std::uint32_t c : strata.order) shot.aim(directions, c, draw);
    hits.assign(shot.rays.size(), Hit{});
    tracer_.intersect(shot.rays, hits);
    counts.distance_rays += shot.rays.size();
    for (const Hit& hit : hits)
      if (hit.surface != kNone) ++met, inverse += 1 / double(std::max(hit.t, closest));
  }
  return met > 0 ? float(met / inverse) : INFINITY;
}

void FinalGather::follow(const SurfacePoint& from, Vec3 normal, GatherRays& shot, GatherCounts& counts) const {
  shot.radiance.resize(shot.rays.size());
  shot.distance.resize(shot.rays.size());
  shot.sources.resize(shot.rays.size());
  incoming_(shot.rays, shot.keys, shot.radiance, shot.distance, counts, shot.sources);
  const Inside inside(around_(from.position, normal, from.offset));
  for (std::size_t i = 0; inside.any() && i < shot.rays.size(); ++i) {
    if (!(shot.distance[i] < INFINITY)) continue;
    const Rgb passed = inside.transmittance_over(tracer_.frame().materials, shot.distance[i]);
    shot.radiance[i] *= passed;
    shot.sources[i].noise *= passed;
  }
  const Bsdf bsdf = incoming_.bsdf_at(from, normal);
  if (!(bsdf.has_specular() && bsdf.has_diffuse())) return;
  for (std::size_t i = 0; i < shot.rays.size(); ++i) {
    const float weight = bsdf.arrival_weight(shot.rays[i].direction, normal);
    shot.radiance[i] *= weight;
    shot.sources[i].noise *= weight;
  }
}

IrradianceRecord FinalGather::gather(const SurfacePoint& from, Vec3 normal, GatherCounts& counts,
                                     float ray_share) const {
  IrradianceRecord record = light(from, normal, counts, ray_share);
  record.radius_unclamped = distance(from, normal, counts);
  return record;
}

IrradianceRecord FinalGather::light(const SurfacePoint& from, Vec3 normal, GatherCounts& counts,
                                    float ray_share) const {
  thread_local Hemisphere sky;
  thread_local GatherRays shot;
  std::size_t halvings = 0;
  for (; halvings < kFewer && ray_share <= 0.5f; ++halvings) ray_share *= 2;
  const GatherStrata& strata = strata_[kFewer - halvings];
  const std::uint64_t key = place_key(from.position, normal, options_.seed);
  const GatherDirections directions(from, normal, strata.rings, strata.sectors, key);
  shot.clear();
  for (const std::uint32_t c : strata.order) shot.aim(directions, c, 0);
  follow(from, normal, shot, counts);

  sky.reset(strata.rings, strata.sectors);
  const float closest = closest_distance(from);
  Rgb points_noise{0.0f};
  for (std::size_t i = 0; i < shot.rays.size(); ++i) {
    sky.radiance[shot.cells[i]] = shot.radiance[i];
    sky.inverse_distance[shot.cells[i]] = 1 / std::max(shot.distance[i], closest);  // 0 if the ray meets nothing
    points_noise += shot.sources[i].noise * (kPi / float(strata.cells()));
  }
  IrradianceRecord record = sky.record(from, normal);
  record.noise = sky.noise(key);
  record.points_noise = points_noise;
  add_explicit(from, key, record, counts);
  return record;
}

void FinalGather::add_explicit(const SurfacePoint& from, std::uint64_t key, IrradianceRecord& record,
                               GatherCounts& counts) const {
  if (!options_.bright) return;
  const Bsdf bsdf = incoming_.bsdf_at(from, record.normal);
  const bool coated = bsdf.has_specular() && bsdf.has_diffuse();
  const PathRandom random(options_.seed ^ 0x6272696768740001ull, key);
  BrightPoints::Receiver at{from, record.normal, coated ? &bsdf : nullptr};
  at.lamps = !options_.lamps_apart;
  add_bright_light(options_.bright->arriving(at, options_.bright_samples, random, counts), record);
}

}  // namespace tempolux
