#include "lib/gather/final_gather.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/ideas.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/gather/hemisphere.h"
#include "lib/material/bsdf.h"
#include "lib/material/inside.h"
#include "lib/material/seen_side.h"
#include "lib/material/surface_material.h"

namespace tempolux {
namespace {

/// Events followed by one ray; roulette ends all but 4e-12 of them before, clear or not.
constexpr int kDeepest = 512;
constexpr float kLargestSurvival = 0.95f;

/// A key from where a point is, to the bit.
std::uint64_t key_of(Vec3 p, Vec3 n, std::uint64_t seed) {
  std::uint64_t key = mix64(seed + 0x6761746865720001ull);
  for (float x : {p.x, p.y, p.z, n.x, n.y, n.z}) key = mix64(key ^ std::bit_cast<std::uint32_t>(x));
  return key;
}

constexpr int kFewRays = 64;         ///< of lit_share()
constexpr std::size_t kAtOnce = 32;  ///< rays whose answers are fetched together
constexpr int kTile = 4;             ///< sectors followed side by side: two rings of them are a packet of rays

/// From one ray of a cell to its next, modulo 1: any number is spread over the cell [R2 of Roberts 2018, shifted].
constexpr Vec2 kStep{0.7548777f, 0.5698403f};
float frac(float x) { return std::min(x - std::floor(x), kOneMinusEpsilon); }

/// Cells of M rings x N sectors, some sectors wide, ring by ring.
std::vector<std::uint32_t> tiled_order(int rings, int sectors) {
  std::vector<std::uint32_t> order;
  for (int first = 0; first < sectors; first += kTile)
    for (int j = 0; j < rings; ++j)
      for (int k = first; k < std::min(first + kTile, sectors); ++k)
        order.push_back(std::uint32_t(j * sectors + k));
  return order;
}

}  // namespace

FinalGather::Strata FinalGather::strata(int rays) {
  Strata made;
  gather_strata(rays, made.rings, made.sectors);
  made.order = tiled_order(made.rings, made.sectors);
  return made;
}

/// Rays from one place through cells of the hemisphere above it, and what comes back along them.
struct FinalGather::Shots {
  const SurfacePoint& from;
  const Frame frame;
  const Vec3 geometric;               ///< normal on the lit side
  const Strata& strata;
  const std::uint64_t key;
  std::vector<Ray> rays;
  std::vector<std::uint64_t> keys;
  std::vector<std::uint32_t> cells;   ///< of the rays
  std::vector<Rgb> radiance;
  std::vector<float> distance;

  Shots(const SurfacePoint& point, Vec3 normal, const Strata& s, std::uint64_t seed)
      : from(point),
        frame(normal),
        geometric(dot(point.normal_geometric, normal) < 0 ? -point.normal_geometric : point.normal_geometric),
        strata(s),
        key(key_of(point.position, normal, seed)) {}

  void clear() {
    rays.clear();
    keys.clear();
    cells.clear();
  }
  /// The sample-th ray of a cell; none if it would start below the surface: nothing arrives from there.
  void aim(std::uint32_t cell, std::uint32_t sample) {
    const PathRandom random(key, cell);
    const Vec2 first = random.get2(0, Purpose::gather);
    const Vec2 u{frac(first.x + float(sample) * kStep.x), frac(first.y + float(sample) * kStep.y)};
    const auto sectors = std::uint32_t(strata.sectors);
    const float sin2 = (float(cell / sectors) + u.x) / float(strata.rings);
    const float phi = 2 * kPi * (float(cell % sectors) + u.y) / float(sectors);
    const float sine = std::sqrt(sin2), cosine = std::sqrt(std::max(1e-6f, 1 - sin2));
    const Vec3 travel = frame.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
    if (!(dot(travel, geometric) > 0)) return;
    rays.push_back(spawn_ray(from, travel));
    keys.push_back(random.bits(1, Purpose::gather, sample));
    cells.push_back(cell);
  }
  void shoot(const FinalGather& gather, GatherCounts& counts) {
    radiance.resize(rays.size());
    distance.resize(rays.size());
    gather.radiance(rays, keys, radiance, distance, counts);
  }
};

FinalGather::FinalGather(const Tracer& tracer, const Lights& lights, const PointLookup& points, const GatherOptions& options)
    : tracer_(tracer), reach_(tracer), lights_(lights), points_(points), options_(options), few_(strata(std::min(kFewRays, options.rays))) {
  for (std::size_t i = 0; i < strata_.size(); ++i) strata_[i] = strata(options.rays << i);
  for (const Material& material : tracer.frame().materials)
    bsdfs_.push_back({Bsdf(material, false), Bsdf(material, true)});
}

/// A surface at a ray's end.
struct FinalGather::Met {
  SurfacePoint hit;
  Vec3 wo, geometric;             ///< geometric: the normal on the side of wo
  float distance = INFINITY;      ///< m, along the path since the gather ray's start
  const Bsdf* bsdf = nullptr;     ///< null: nothing was met
  std::optional<Bsdf> textured;   ///< what bsdf points to where the material has textures
};

/// A ray that goes on from a hit, and what is to become of the radiance along it. All of one depth follow together.
struct FinalGather::Further {
  Ray ray;
  std::uint64_t key = 0;
  Rgb weight{0.0f};
  std::size_t of = 0;        ///< the gather ray
  bool sees_lamps = false;   ///< beyond events S: light of kind caustic where it started, which no point has told
};

/// Fills in the rest where met.hit is known. A material with textures is made for this hit; a normal map bends its normal.
inline void FinalGather::meet(Vec3 wo, float distance, Met& met) const {
  const float cosine = dot(met.hit.normal_geometric, wo);
  met.bsdf = &bsdfs_[met.hit.material][cosine > 0];
  if (tracer_.frame().materials[met.hit.material].textures) [[unlikely]] {
    const SurfaceMaterial material(tracer_.frame(), met.hit);
    met.bsdf = &met.textured.emplace(material, cosine > 0);
  }
  met.wo = wo;
  met.geometric = cosine < 0 ? -met.hit.normal_geometric : met.hit.normal_geometric;
  met.distance = distance;
}

/// take(i, met, point) for each ray that meets a surface, in order; point: what to read there, if anything. alike: as
/// Tracer::intersect.
template <class Take>
void FinalGather::follow(std::span<const Ray> rays, bool alike, GatherCounts& counts, const Take& take) const {
  std::array<Hit, kAtOnce> hits;
  std::array<Met, kAtOnce> met;
  std::array<PointLookup::Question, kAtOnce> questions;
  std::array<PointLookup::Answer, kAtOnce> answers;
  for (std::size_t first = 0; first < rays.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, rays.size() - first);
    tracer_.intersect(rays.subspan(first, count), std::span(hits).first(count), alike);
    for (std::size_t i = 0; i < count; ++i) {
      met[i].bsdf = nullptr;
      if (hits[i].surface == kNone) continue;
      const Ray& ray = rays[first + i];
      tracer_.surface_points(std::span(hits).subspan(i, 1), &met[i].hit);
      meet(-ray.direction, length(met[i].hit.position - ray.origin), met[i]);
      if (met[i].bsdf->has_diffuse()) questions[i] = points_.ask(met[i].hit.position, met[i].geometric);
    }
    const auto reads_point = [&](std::size_t i) { return met[i].bsdf && met[i].bsdf->has_diffuse(); };
    for (std::size_t i = 0; i < count; ++i)
      if (reads_point(i)) answers[i] = points_.answer(questions[i]);
    for (std::size_t i = 0; i < count; ++i)
      if (met[i].bsdf) take(first + i, met[i], reads_point(i) ? points_.read(questions[i], answers[i]) : nullptr);
  }
  counts.rays += rays.size();
}

void FinalGather::radiance(std::span<const Ray> rays, std::span<const std::uint64_t> keys,
                           std::span<Rgb> radiance, std::span<float> distance, GatherCounts& counts) const {
  thread_local std::vector<Further> now, next;
  thread_local std::vector<Ray> further_rays;
  std::fill(radiance.begin(), radiance.end(), Rgb(0.0f));
  std::fill(distance.begin(), distance.end(), INFINITY);
  next.clear();
  follow(rays, true, counts, [&](std::size_t i, const Met& met, const PointLookup::Light* point) {
    distance[i] = met.distance;
    radiance[i] = reflected(met, point, {{}, keys[i], Rgb(1.0f), i}, 0, counts, next);
  });
  for (int depth = 1; !next.empty(); ++depth) {
    std::swap(now, next);
    next.clear();
    further_rays.clear();
    for (const Further& f : now) further_rays.push_back(f.ray);
    follow(further_rays, false, counts, [&](std::size_t i, const Met& met, const PointLookup::Light* point) {
      const Further from = now[i];
      radiance[from.of] += from.weight * reflected(met, point, from, depth, counts, next);
    });
  }
}

/// From 1/2 to 1 1/2, for all that depends on how near a hit is: no seam where that begins.
inline float FinalGather::threshold(const PathRandom& random) { return 0.5f + random.get1(0, Purpose::gather); }

/// Is the hit too near for its point to be read: within about near_factor radii of the estimate behind it?
inline bool FinalGather::is_near(const Met& met, const PointLookup::Light& point, const PathRandom& random) const {
  // Most hits are far from the seam: they need no random number.
  if (!used(Idea::near_hits)) return false;
  const float reach = options_.near_factor * point.radius;
  if (!(met.distance < 1.5f * reach)) return false;
  return met.distance < 0.5f * reach || met.distance < reach * threshold(random);
}

/// What the surface at a ray's end sends back along it, emission left out: its Lambert lobe by the point to read there, or by
/// going on where none stands for the hit or a first hit is near; its other lobes by following one of them. `further` receives
/// the ray that goes on from a Lambert lobe, if any.
Rgb FinalGather::reflected(const Met& met, const PointLookup::Light* point, const Further& from, int depth, GatherCounts& counts,
                           std::vector<Further>& further) const {
  const Bsdf& bsdf = *met.bsdf;
  const bool specular = bsdf.has_specular();
  std::optional<SeenSide> side;
  if (specular) side.emplace(met.hit, met.wo);
  const PathRandom random(from.key, std::uint64_t(depth));
  Rgb result{0.0f};
  if (bsdf.has_diffuse()) {
    const Rgb scale = bsdf.diffuse_reflectance(side ? side->wo_local.z : 1) * kInvPi;
    if (point && (depth > 0 || !is_near(met, *point, random))) {
      ++counts.points_read;
      result = scale * (points_.is_even(*point) ? point->all : beside_edge(met, *point, random, counts));
    } else {
      result = scale * scattered(met, point, from, scale, random, depth, counts, further);
    }
  }
  if (!specular || depth >= kDeepest) return result;
  // Other lobes: one sampled direction, by roulette on its weight; the Lambert lobe was read above.
  const MaterialValues& material = tracer_.frame().materials[met.hit.material];
  const bool front = dot(met.hit.normal_geometric, met.wo) > 0, solid = is_solid_glass(material);
  const auto next = bsdf.sample(side->wo_local, random.get1(2, Purpose::lobe), random.get2(2, Purpose::scatter));
  if (next.diffuse || is_black(next.weight)) return result;
  const Vec3 travel = side->frame.to_world(next.wi);
  if ((next.transmitted ? -1.0f : 1.0f) * dot(travel, met.geometric) <= 0) return result;
  const float survival = std::min(0.95f, max_component(next.weight));
  if (!(random.get1(2, Purpose::roulette) < survival)) return result;
  const Rgb weight = next.weight * (1 / survival);
  Further beyond = from;
  beyond.key = mix64(from.key + 2);
  beyond.weight *= weight;
  return result + weight * reflected_beyond(met.hit, travel, met.distance, beyond, depth + 1, counts, further,
                                            solid && front == next.transmitted ? &material : nullptr);
}

/// Radiance along a ray that goes on after an event S at `start`, `distance` on the way already, inside a solid of glass or not.
Rgb FinalGather::reflected_beyond(const SurfacePoint& start, Vec3 travel, float distance, Further from, int depth,
                                  GatherCounts& counts, std::vector<Further>& further, const MaterialValues* inside) const {
  Hit hit;
  ++counts.rays;
  if (!tracer_.intersect(spawn_ray(start, travel), hit))
    return from.sees_lamps && lights_.has_environment() ? lights_.environment(travel) : Rgb(0.0f);
  Met met;
  met.hit = tracer_.surface_point(hit);
  const float on = length(met.hit.position - start.position);
  const Rgb left = inside ? transmittance(*inside, on) : Rgb(1.0f);
  from.weight *= left;
  meet(-travel, distance + on, met);
  const Rgb emitted = from.sees_lamps ? lights_.emitted(met.hit, met.wo, 0) : Rgb(0.0f);
  const PointLookup::Light* point = met.bsdf->has_diffuse() ? points_.find(met.hit.position, met.geometric) : nullptr;
  return left * (emitted + reflected(met, point, from, depth, counts, further));
}

/// Irradiance at a hit but for what arrives along the ray that goes on, which `further` receives. Near hits take caustic light
/// from the point that stands for them; direct light too, which is known to the spacing of the points instead of an estimate's
/// radius, if they are farther than about that; else by light sampling. Without a point all but direct light is the ray's.
Rgb FinalGather::scattered(const Met& met, const PointLookup::Light* point, const Further& from, Rgb scale, const PathRandom& random,
                           int depth, GatherCounts& counts, std::vector<Further>& further) const {
  ++(point ? counts.near_hits : counts.unanswered);
  const SeenSide side(met.hit, met.wo);
  Rgb irradiance{0.0f};
  if (point) irradiance = points_.point(*point).caustic;
  if (point && points_.is_even(*point) && met.distance >= points_.spacing() * threshold(random)) irradiance += points_.point(*point).direct;
  else irradiance += sampled_light(met, side, random, counts);
  // Each by itself. Spread over near hits side by side (a sequence), records in corners had half the noise, but came out 5 %
  // bright: cells get further rays by what neighbours saw, on which their own value must not depend.
  const Vec3 drawn = sample_hemisphere_cos(random.get2(1, Purpose::scatter)), travel = side.frame.to_world(drawn);
  if (!(dot(travel, met.geometric) > 0)) return irradiance;
  Rgb weight = from.weight * scale * (kPi * met.bsdf->arrival_weight(drawn.z));
  if (depth > 0) {
    const float survival = std::min(kLargestSurvival, max_component(weight));
    if (!(random.get1(1, Purpose::roulette) < survival)) return irradiance;
    weight *= 1 / survival;
  }
  further.push_back({spawn_ray(met.hit, travel), mix64(from.key + 1), weight, from.of, !point});
  return irradiance;
}

/// Direct irradiance at a hit by one light sample.
Rgb FinalGather::sampled_light(const Met& met, const SeenSide& side, const PathRandom& random, GatherCounts& counts) const {
  LightSample light;
  if (lights_.empty() || !lights_.sample(met.hit.position, side.normal, random.get1(1, Purpose::light_choice),
                                         random.get2(1, Purpose::light_point), light) || !side.sees(light.wi))
    return Rgb(0.0f);
  ++counts.shadow_rays;
  if (tracer_.occluded(spawn_shadow_ray(met.hit, light.position, light.position_offset))) return Rgb(0.0f);
  const float cosine = dot(light.wi, side.normal);
  return light.radiance * (cosine * met.bsdf->arrival_weight(cosine));
}

/// Irradiance at a hit where the point's direct light is not its own.
Rgb FinalGather::beside_edge(const Met& met, const PointLookup::Light& light, const PathRandom& random, GatherCounts& counts) const {
  const IrradiancePoint& point = points_.point(light);
  return point.indirect + point.caustic + sampled_light(met, SeenSide(met.hit, met.wo), random, counts);
}

void FinalGather::look_around(const SurfacePoint& from, IrradianceRecord& record) const {
  const Vec3 lit = dot(from.normal_geometric, record.normal) < 0 ? -from.normal_geometric : from.normal_geometric;
  record.clearance = reach_.clearance(from.position, lit, record.normal, record.radius * Clearance::kPerRadius);
}

float FinalGather::lit_share(const SurfacePoint& from, Vec3 normal, GatherCounts& counts) const {
  Shots shots(from, normal, few_, options_.seed ^ 0x6c69745f73686172ull);
  for (const std::uint32_t c : few_.order) shots.aim(c, 0);
  shots.shoot(*this, counts);
  thread_local Hemisphere sky;
  sky.reset(few_.rings, few_.sectors);
  for (std::size_t i = 0; i < shots.rays.size(); ++i) sky.radiance[shots.cells[i]] = shots.radiance[i];
  return sky.lit_cells() / float(few_.order.size());
}

IrradianceRecord FinalGather::gather(const SurfacePoint& from, Vec3 normal, GatherCounts& counts, float expected_share) const {
  thread_local Hemisphere sky;
  thread_local std::vector<std::uint8_t> further;
  std::size_t times = 0;   // twofold
  while (times + 1 < strata_.size() && expected_share * float(1 << times) < kEnoughLit) ++times;
  const std::vector<std::uint32_t>& order = strata_[times].order;
  Shots shots(from, normal, strata_[times], options_.seed);
  sky.reset(shots.strata.rings, shots.strata.sectors);
  const float closest = std::max(4 * from.offset, 1e-30f);
  Met here;
  here.hit = from;
  meet(normal, 0, here);
  const Bsdf& bsdf = *here.bsdf;
  const bool coated = bsdf.has_specular() && bsdf.has_diffuse();
  const auto shoot = [&] {
    shots.shoot(*this, counts);
    if (coated)
      for (std::size_t i = 0; i < shots.rays.size(); ++i)
        shots.radiance[i] *= bsdf.arrival_weight(dot(shots.rays[i].direction, normal));
  };

  for (const std::uint32_t c : order) shots.aim(c, 0);
  shoot();
  for (std::size_t i = 0; i < shots.rays.size(); ++i) {
    sky.radiance[shots.cells[i]] = shots.radiance[i];
    sky.inverse_distance[shots.cells[i]] = 1 / std::max(shots.distance[i], closest);   // 0 for a miss
  }
  IrradianceRecord record;
  record.position = from.position;
  record.normal = normal;
  record.object = from.object;
  record.expected_share = expected_share;
  sky.translational_gradient(shots.frame, record);
  record.lit_cells = sky.lit_cells();
  record.lit_share = record.lit_cells / float(order.size());
  if (options_.curvature) record.curvature = sky.curvature();
  record.radius_unclamped = sky.harmonic_distance();
  record.radius = sky.nearest_across();

  // More rays where light is uneven: a cell's value becomes the mean of all of its own.
  if (used(Idea::further_rays)) sky.further_rays(further);
  else further.assign(order.size(), 0);
  shots.clear();
  for (const std::uint32_t c : order)
    for (std::uint32_t sample = 1; sample <= further[c]; ++sample) shots.aim(c, sample);
  shoot();
  for (std::size_t c = 0; c < further.size(); ++c)
    if (further[c] > 0) sky.radiance[c] *= 1 / float(1 + further[c]);
  for (std::size_t i = 0; i < shots.rays.size(); ++i) {
    const std::uint32_t c = shots.cells[i];
    sky.radiance[c] += shots.radiance[i] * (1 / float(1 + further[c]));
  }
  sky.irradiance_and_rotational_gradient(shots.frame, record);
  return record;
}

}  // namespace tempolux
