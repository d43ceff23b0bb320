#include "lib/gather/irradiance_points.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/core/frame.h"
#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/density/irradiance_estimate.h"
#include "lib/density/morton.h"
#include "lib/material/bsdf.h"

namespace tempolux {
namespace {

constexpr float kFlattening = 10;      ///< of the search's ellipsoid along the normal
constexpr float kMinCos = 0.1f;        ///< of a photon's and the point's normal
constexpr int kMoreProbes = 4;         ///< times as many where one fails

double triangle_area(const Surface& surface, const std::array<std::uint32_t, 3>& t) {
  const Vec3 a = surface.positions[t[0]];
  return 0.5 * double(length(cross(surface.positions[t[1]] - a, surface.positions[t[2]] - a)));
}

bool stores_light(const SceneFrame& frame, const Surface& surface) {
  return Bsdf(frame.materials[surface.material]).has_lambert();
}

double storing_area(const SceneFrame& frame) {
  double area = 0;
  for (const Surface& surface : frame.surfaces)
    if (stores_light(frame, surface))
      for (const auto& t : surface.primitive->triangles) area += triangle_area(surface, t);
  return area;
}

/// One surface's points, both sides: a scrambled Sobol sequence along the line of its triangles' areas. `rank`
/// tells surfaces of one object apart.
void place_on(const Surface& surface, std::uint32_t rank, double area_per_point, std::uint64_t seed,
              std::vector<IrradiancePoint>& points) {
  const auto& triangles = surface.primitive->triangles;
  std::vector<double> cumulative;
  double area = 0;
  for (const auto& t : triangles) cumulative.push_back(area += triangle_area(surface, t));
  if (!(area > 0)) return;
  const auto count = std::uint32_t(std::max(1.0, std::ceil(area / area_per_point)));
  for (std::uint32_t side = 0; side < 2; ++side) {
    const std::uint64_t key = PathRandom(seed, surface.object).bits(rank, Purpose::points, side);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec2 u = sobol_owen_2d(i, key);
      const double along = double(u.x) * area;
      const auto found = std::upper_bound(cumulative.begin(), cumulative.end() - 1, along);
      const auto at = std::size_t(found - cumulative.begin());
      const double first = at ? cumulative[at - 1] : 0, width = cumulative[at] - first;
      const float within = width > 0 ? float(std::clamp((along - first) / width, 0.0, 0.999999)) : 0.5f;
      const auto& t = triangles[at];
      const Vec3 a = surface.positions[t[0]], b = surface.positions[t[1]], c = surface.positions[t[2]];
      const Vec2 bary = sample_triangle({within, u.y});
      IrradiancePoint point;
      point.position = a * (1 - bary.x - bary.y) + b * bary.x + c * bary.y;
      point.normal = normalize(cross(b - a, c - a)) * (side == 0 ? 1.0f : -1.0f);
      point.object = surface.object;
      if (length2(point.normal) > 0) points.push_back(point);
    }
  }
}

/// Estimates one thread's points.
class PointEstimator {
 public:
  PointEstimator(const Tracer& tracer, const Lights& lights, const PointOptions& options, float offset)
      : tracer_(tracer), lights_(lights), options_(options), offset_(offset) {
    irradiance_.neighbours = options.neighbours;
    irradiance_.max_radius = options.max_radius;
    irradiance_.min_cos = kMinCos;
    irradiance_.flattening = kFlattening;
  }

  /// Mean over stratified light samples of radiance cos / pdf where nothing is in between.
  Rgb direct(const IrradiancePoint& point, const PathRandom& random) const {
    Rgbd sum{0.0};
    const SurfacePoint from = surface_point(point);
    const int n = options_.light_samples;
    for (int s = 0; s < n; ++s) {
      const float u = (float(s) + random.get1(0, Purpose::light_choice, std::uint32_t(s))) / float(n);
      LightSample light;
      if (!lights_.sample(point.position, point.normal, std::min(u, kOneMinusEpsilon),
                          random.get2(0, Purpose::light_point, std::uint32_t(s)), light))
        continue;
      const float cosine = dot(light.wi, point.normal);
      if (!(cosine > 0) || tracer_.occluded(spawn_shadow_ray(from, light.position, light.position_offset))) continue;
      sum += Rgbd(light.radiance) * double(cosine);
    }
    return Rgb(sum / double(n));
  }

  /// Density of the photons of one index; `radius` receives the disc's.
  Rgb density(const PhotonIndex& index, const IrradiancePoint& point, const PathRandom& random, float& radius) const {
    radius = 0;
    if (index.size() == 0) return Rgb(0.0f);
    PhotonQuery query{point.position, point.normal, irradiance_.max_radius, kMinCos, kFlattening, kAllKinds};
    thread_local NeighbourList found;
    index.find_nearest(query, options_.neighbours, found);
    if (found.count() == 0) return Rgb(0.0f);
    const bool full = int(found.count()) == options_.neighbours;
    const std::size_t farthest = full ? found.farthest() : found.count();
    radius = full ? std::sqrt(found.distance2()[farthest]) : irradiance_.max_radius;
    if (!(radius > 4 * offset_)) {  // closer than coordinates can tell: the plain rule copes
      const IrradianceEstimate plain = estimate_irradiance(index, point.position, point.normal, irradiance_, found);
      radius = plain.radius;
      return Rgb(plain.irradiance);
    }
    bool whole = true;
    const double area = reachable_area(point, radius, random, whole);
    if (!(area > 0)) return Rgb(0.0f);
    Rgbd flux{0.0};
    for (std::size_t i = 0; i < found.count(); ++i) {
      if (i == farthest) continue;
      const std::uint32_t photon = found.photons()[i];
      if (whole || reaches(point, index.position(photon))) flux += Rgbd(index.flux(photon));
    }
    const Rgbd irradiance = flux / area;
    return Rgb(Rgbd{std::max(0.0, irradiance.r), std::max(0.0, irradiance.g), std::max(0.0, irradiance.b)});
  }

 private:
  SurfacePoint surface_point(const IrradiancePoint& point) const {
    SurfacePoint from;
    from.position = point.position;
    from.normal = from.normal_geometric = point.normal;
    from.offset = offset_;
    return from;
  }

  /// Can light that falls on `place` be taken for light near the point? Either nothing is between the two, or
  /// nothing is on the way across the tangent plane and down from there: the straight line cuts through a
  /// surface that bends away, the other way through one that bends up.
  bool reaches(const IrradiancePoint& point, Vec3 place) const {
    const Vec3 lift = point.normal * (2 * offset_), from = point.position + lift, to = place + lift;
    if (free(from, to)) return true;
    const float below = dot(point.position - place, point.normal);
    if (!(below > 0)) return false;
    const Vec3 corner = to + point.normal * below;
    return free(from, corner) && free(corner, to);
  }
  bool free(Vec3 from, Vec3 to) const { return !tracer_.occluded({from, to - from, 0, 1 - 0x1p-10f}); }

  /// Area of surface that stores photons inside the disc's ellipsoid and can be reached from its middle; of a
  /// tilted part its true area, not its shadow on the tangent plane.
  double reachable_area(const IrradiancePoint& point, float radius, const PathRandom& random, bool& whole) const {
    const Frame frame(point.normal);
    double sum = 0;
    int probes = options_.area_probes, failed = 0, done = 0;
    for (int round = 0; round < 2; ++round) {
      for (; done < probes; ++done) {
        const Vec2 u = sobol_owen_2d(std::uint32_t(done), random.bits(1, Purpose::points));
        const Vec2 d = sample_disc_concentric(u);
        const float share = probe(point, frame, d, radius);
        sum += double(share);
        failed += share == 0;
      }
      if (failed == 0 || round == 1) break;
      probes *= kMoreProbes;
    }
    whole = failed == 0;
    return double(kPi) * double(radius) * double(radius) * sum / probes;
  }

  /// 0 if the place d of the unit disc cannot be reached, else 1 / cos of the surface's tilt there.
  float probe(const IrradiancePoint& point, const Frame& frame, Vec2 d, float radius) const {
    const float height =
        std::max(4 * offset_, radius / kFlattening * std::sqrt(std::max(0.0f, 1 - d.x * d.x - d.y * d.y)));
    const Vec3 start = point.position + point.normal * (2 * offset_);
    const Vec3 corner = start + (frame.tangent * d.x + frame.bitangent * d.y) * radius;
    Hit hit;
    if (free(start, corner) && tracer_.intersect({corner, -point.normal, 0, height + 2 * offset_}, hit))
      return tilt(point, hit);
    // Not across and down: a surface that rises within the ellipsoid, seen straight.
    if (!tracer_.intersect({corner + point.normal * height, -point.normal, 0, height}, hit)) return 0;
    if (!free(start, tracer_.surface_point(hit).position + point.normal * (2 * offset_))) return 0;
    return tilt(point, hit);
  }

  /// 1 / cos of the angle between the surface that was hit and the tangent plane; 0 if no photon of it counts.
  float tilt(const IrradiancePoint& point, const Hit& hit) const {
    const SurfacePoint there = tracer_.surface_point(hit);
    const float cosine = std::abs(dot(there.normal_geometric, point.normal));
    if (cosine <= kMinCos || !Bsdf(tracer_.frame().materials[there.material]).has_lambert()) return 0;
    return 1 / cosine;
  }

  const Tracer& tracer_;
  const Lights& lights_;
  const PointOptions& options_;
  const float offset_;
  IrradianceOptions irradiance_;
};

PhotonIndex index_of_kind(std::span<const formats::Photon> photons, formats::PathKind kind, Vec3d shift) {
  std::vector<formats::Photon> chosen;
  for (const formats::Photon& photon : photons) {
    if (photon.kind != kind) continue;
    chosen.push_back(photon);
    auto& p = chosen.back().position;
    p = {float(double(p[0]) + shift.x), float(double(p[1]) + shift.y), float(double(p[2]) + shift.z)};
  }
  return PhotonIndex(chosen);
}

}  // namespace

float point_spacing(const SceneFrame& frame, const PointOptions& options) {
  return float(std::sqrt(storing_area(frame) / std::max(1u, options.count)));
}

std::vector<IrradiancePoint> place_points(const SceneFrame& frame, const PointOptions& options) {
  std::vector<IrradiancePoint> points;
  const double spacing = double(point_spacing(frame, options));
  std::map<std::uint32_t, std::uint32_t> rank;
  for (const Surface& surface : frame.surfaces) {
    const std::uint32_t r = rank[surface.object]++;
    if (stores_light(frame, surface)) place_on(surface, r, spacing * spacing, options.seed, points);
  }
  return points;
}

void estimate_points(const Tracer& tracer, const Lights& lights, std::span<const formats::Photon> photons,
                     Vec3d photon_shift, const PointOptions& options, std::vector<IrradiancePoint>& points) {
  const PhotonIndex caustic = index_of_kind(photons, formats::PathKind::caustic, photon_shift);
  const PhotonIndex indirect = index_of_kind(photons, formats::PathKind::indirect, photon_shift);
  const Box3& bounds = tracer.frame().bounds;
  PointOptions resolved = options;
  if (!(resolved.max_radius > 0)) resolved.max_radius = 0.05f * bounds.diagonal();
  const float offset = 0x1p-20f * max_component(max(abs(bounds.lower), abs(bounds.upper)));
  const PointEstimator estimator(tracer, lights, resolved, offset);

  // Neighbours in space one after the other: look-ups and rays find their data in cache.
  std::vector<Vec3> positions;
  for (const IrradiancePoint& point : points) positions.push_back(point.position);
  const std::vector<std::uint32_t> order = morton_order(positions);
  parallel_chunks(points.size(), 256, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      IrradiancePoint& point = points[order[i]];
      const PathRandom random(options.seed ^ 0x706f696e74ull, order[i]);
      point.direct = lights.empty() ? Rgb(0.0f) : estimator.direct(point, random);
      float unused;
      point.caustic = estimator.density(caustic, point, random, unused);
      point.indirect = estimator.density(indirect, point, random, point.radius);
    }
  });
}

}  // namespace tempolux
