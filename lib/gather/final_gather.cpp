#include "lib/gather/final_gather.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/material/bsdf.h"

namespace tempolux {
namespace {

constexpr int kDeepestSpecular = 32;   ///< events S in a row followed by one ray; roulette ends them long before

/// A key from where a point is, to the bit.
std::uint64_t key_of(Vec3 p, Vec3 n, std::uint64_t seed) {
  std::uint64_t key = mix64(seed + 0x6761746865720001ull);
  for (float x : {p.x, p.y, p.z, n.x, n.y, n.z}) key = mix64(key ^ std::bit_cast<std::uint32_t>(x));
  return key;
}

/// Integral of tan over a ring's share of the projected hemisphere: asin sqrt s - sqrt(s (1 - s)).
double ring_integral(double s) { return std::asin(std::sqrt(s)) - std::sqrt(s * (1 - s)); }

/// The lit side of a hit as seen along wo.
struct Side {
  Vec3 geometric, shading;
  Frame frame;
  Vec3 wo_local;
  Bsdf bsdf;
  Side(const SurfacePoint& p, Vec3 wo, const Material& material)
      : geometric(dot(p.normal_geometric, wo) < 0 ? -p.normal_geometric : p.normal_geometric),
        shading(viewed(dot(p.normal, geometric) < 0 ? -p.normal : p.normal, geometric, wo)),
        frame(shading),
        wo_local(frame.to_local(wo)),
        bsdf(material, dot(p.normal_geometric, wo) > 0) {}
  static Vec3 viewed(Vec3 n, Vec3 geometric, Vec3 wo) { return dot(n, wo) > 1e-4f ? n : geometric; }
};

}  // namespace

void gather_strata(int rays, int& rings, int& sectors) {
  rings = std::max(1, int(std::lround(std::sqrt(double(rays) / M_PI))));
  sectors = std::max(3, int(std::lround(double(rays) / rings)));
}

FinalGather::FinalGather(const Tracer& tracer, const Lights& lights, const PointLookup& points, const GatherOptions& options)
    : tracer_(tracer), lights_(lights), points_(points), options_(options) {
  gather_strata(options.rays, rings_, sectors_);
  for (int j = 0; j < rings_; ++j)
    ring_tangent_.push_back(float(rings_ * (ring_integral(double(j + 1) / rings_) - ring_integral(double(j) / rings_))));
}

Rgb FinalGather::radiance(const Ray& start, std::uint64_t key, float& distance, GatherCounts& counts) const {
  distance = INFINITY;
  ++counts.rays;
  Hit hit;
  if (!tracer_.intersect(start, hit)) return Rgb(0.0f);
  const SurfacePoint point = tracer_.surface_point(hit);
  distance = length(point.position - start.origin);
  return reflected(point, -start.direction, distance, key, 0, counts);
}

/// What the surface at a ray's end sends back along it, emission left out: its Lambert lobe by the point to
/// read there (or one more bounce if the hit is near), its other lobes by following one of them.
Rgb FinalGather::reflected(const SurfacePoint& hit, Vec3 wo, float distance, std::uint64_t key, int depth,
                           GatherCounts& counts) const {
  const Side side(hit, wo, tracer_.frame().materials[hit.material]);
  Rgb result{0.0f};
  const PathRandom random(key, std::uint64_t(depth));
  if (side.bsdf.has_diffuse()) {
    const Rgb rho = side.bsdf.diffuse_reflectance(side.wo_local.z);
    const PointLight* point = points_.find(hit.position, side.geometric, hit.object);
    if (!point) {
      ++counts.unanswered;
    } else {
      ++counts.points_read;
      // A random threshold between one and two times the near distance: no seam where it begins.
      const float limit = options_.near_factor * point->radius * (0.5f + random.get1(0, Purpose::gather));
      if (depth > 0 || distance >= limit) {
        result += rho * kInvPi * point->total();
      } else {
        ++counts.near_hits;
        Rgb irradiance = point->caustic;
        LightSample light;
        if (!lights_.empty() && lights_.sample(hit.position, side.shading, random.get1(1, Purpose::light_choice), random.get2(1, Purpose::light_point), light)) {
          const float cosine = dot(light.wi, side.shading);
          if (cosine > 0 && dot(light.wi, side.geometric) > 0 &&
              !tracer_.occluded(spawn_shadow_ray(hit, light.position, light.position_offset)))
            irradiance += light.radiance * cosine;
        }
        const Vec3 travel = side.frame.to_world(sample_hemisphere_cos(random.get2(1, Purpose::scatter)));
        Hit next;
        ++counts.rays;
        if (dot(travel, side.geometric) > 0 && tracer_.intersect(spawn_ray(hit, travel), next)) {
          const SurfacePoint there = tracer_.surface_point(next);
          irradiance += kPi * reflected(there, -travel, length(there.position - hit.position), mix64(key + 1), depth + 1, counts);
        }
        result += rho * kInvPi * irradiance;
      }
    }
  }
  if (!side.bsdf.has_specular() || depth >= kDeepestSpecular) return result;
  // Other lobes: one sampled direction, by roulette on its weight; the Lambert lobe was read above.
  const auto next = side.bsdf.sample(side.wo_local, random.get1(2, Purpose::lobe), random.get2(2, Purpose::scatter));
  if (next.diffuse || is_black(next.weight)) return result;
  const Vec3 travel = side.frame.to_world(next.wi);
  if ((next.transmitted ? -1.0f : 1.0f) * dot(travel, side.geometric) <= 0) return result;
  const float survival = std::min(0.95f, max_component(next.weight));
  if (!(random.get1(2, Purpose::roulette) < survival)) return result;
  Hit hit2;
  ++counts.rays;
  if (!tracer_.intersect(spawn_ray(hit, travel), hit2)) return result;
  const SurfacePoint there = tracer_.surface_point(hit2);
  return result + next.weight * (1 / survival) *
                      reflected(there, -travel, distance + length(there.position - hit.position), mix64(key + 2), depth + 1, counts);
}

IrradianceRecord FinalGather::gather(const SurfacePoint& from, Vec3 normal, GatherCounts& counts) const {
  const int M = rings_, N = sectors_;
  thread_local std::vector<Rgb> radiance_of;
  thread_local std::vector<float> inverse_distance;
  radiance_of.assign(std::size_t(M) * std::size_t(N), Rgb(0.0f));
  inverse_distance.assign(radiance_of.size(), 0.0f);
  const auto cell = [N](int j, int k) { return std::size_t(j) * std::size_t(N) + std::size_t(k); };

  const Frame frame(normal);
  const Vec3 geometric = dot(from.normal_geometric, normal) < 0 ? -from.normal_geometric : from.normal_geometric;
  const std::uint64_t key = key_of(from.position, normal, options_.seed);
  const float closest = std::max(4 * from.offset, 1e-30f);
  for (int j = 0; j < M; ++j)
    for (int k = 0; k < N; ++k) {
      const PathRandom random(key, cell(j, k));
      const Vec2 u = random.get2(0, Purpose::gather);
      const float sin2 = (float(j) + u.x) / float(M), phi = 2 * kPi * (float(k) + u.y) / float(N);
      const float sine = std::sqrt(sin2), cosine = std::sqrt(std::max(1e-6f, 1 - sin2));
      const Vec3 travel = frame.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
      if (!(dot(travel, geometric) > 0)) continue;
      float distance;
      radiance_of[cell(j, k)] = radiance(spawn_ray(from, travel), random.bits(1, Purpose::gather), distance, counts);
      inverse_distance[cell(j, k)] = 1 / std::max(distance, closest);   // 0 for a miss
    }

  IrradianceRecord record;
  record.position = from.position;
  record.normal = normal;
  record.object = from.object;
  Rgbd sum{0.0};
  double inverse_sum = 0;
  std::array<Vec3d, 3> rotational{}, translational{};
  for (int k = 0; k < N; ++k) {
    const double middle = 2 * M_PI * (k + 0.5) / N, lower = 2 * M_PI * double(k) / N;
    const Vec3d u{std::cos(middle), std::sin(middle), 0}, v{-std::sin(middle), std::cos(middle), 0};
    const Vec3d v_lower{-std::sin(lower), std::cos(lower), 0};
    Rgbd turn{0.0}, along{0.0}, across{0.0};
    for (int j = 0; j < M; ++j) {
      const Rgbd here(radiance_of[cell(j, k)]);
      const double near_here = double(inverse_distance[cell(j, k)]);
      sum += here;
      inverse_sum += near_here;
      turn += here * double(ring_tangent_[std::size_t(j)]);
      const double s_lower = std::sqrt(double(j) / M), s_upper = std::sqrt(double(j + 1) / M);
      if (j > 0) {
        const Rgbd inner(radiance_of[cell(j - 1, k)]);
        const double near = std::max(near_here, double(inverse_distance[cell(j - 1, k)]));
        along += (here - inner) * (s_lower * (1 - s_lower * s_lower) * near);
      }
      const std::size_t before = cell(j, (k + N - 1) % N);
      const double near = std::max(near_here, double(inverse_distance[before]));
      across += (here - Rgbd(radiance_of[before])) * ((s_upper - s_lower) * near);
    }
    for (int c = 0; c < 3; ++c) {
      rotational[std::size_t(c)] += v * (turn[c] * M_PI / (double(M) * N));
      translational[std::size_t(c)] += u * (along[c] * 2 * M_PI / N) + v_lower * across[c];
    }
  }
  record.irradiance = Rgb(sum * (M_PI / (double(M) * N)));
  for (std::size_t c = 0; c < 3; ++c) {
    record.rotational[c] = frame.to_world(Vec3(rotational[c]));
    record.translational[c] = frame.to_world(Vec3(translational[c]));
  }
  record.radius_unclamped = inverse_sum > 0 ? float(double(M) * N / inverse_sum) : INFINITY;
  float nearest = 0;
  for (int k = 0; k < N; ++k) nearest = std::max(nearest, inverse_distance[cell(M - 1, k)]);
  record.radius = nearest > 0 ? 1 / nearest : INFINITY;
  return record;
}

}  // namespace tempolux
