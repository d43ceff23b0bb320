#include "lib/gather/point_density.h"

#include <algorithm>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/density/irradiance_estimate.h"
#include "lib/material/surface_material.h"

namespace tempolux {
namespace {

constexpr float kFlattening = 10;  ///< of the search's ellipsoid along the normal
constexpr float kMinCos = 0.1f;    ///< of a photon's and the point's normal
constexpr int kRim = 16;           ///< places on the rim that are looked at first
constexpr float kFlat = 0.005f;    ///< of the radius: how far off the plane the rim of a flat disc may lie
constexpr int kMostProbes = 32;    ///< times area_probes
constexpr int kMostInColumn = 8;   ///< surfaces on top of each other
constexpr std::size_t kFirstTested = 4;   ///< photons of a sampled estimate
constexpr int kProbesIfOpen = 3;          ///< of its area, if these can be reached

}  // namespace

// All rays here meet surfaces of alpha mode BLEND wherever they are at all: what such a surface lets pass is in the
// photons' flux already (photon_trace.h), its area is there.

Reach::Reach(const Tracer& tracer) : tracer_(tracer) {
  const Box3& bounds = tracer.frame().bounds;
  offset_ = 0x1p-20f * max_component(max(abs(bounds.lower), abs(bounds.upper)));
}

bool Reach::free(Vec3 from, Vec3 to) const { return !tracer_.occluded({from, to - from, 0, 1, true}); }

bool Reach::operator()(Vec3 from, Vec3 normal, Vec3 to, Vec3 to_normal) const {
  const Vec3 start = from + normal * (2 * offset_), end = to + to_normal * (2 * offset_);
  // Both ends stand on the lit sides: a ray from behind `to` meets the surface that `to` is on just before
  // its end.
  if (free(start, end)) return true;
  const float below = dot(from - to, normal);
  if (!(below > 0)) return false;
  const Vec3 corner = end + normal * below;
  return free(start, corner) && free(corner, end);
}

PointDensity::PointDensity(const Tracer& tracer, std::span<const formats::Photon> photons, const DensityOptions& options,
                           std::uint8_t kinds, Vec3d shift)
    : tracer_(tracer),
      options_(options),
      reach_(tracer),
      index_(photons, kinds, shift),
      facing_(index_, options.max_radius) {
  for (const Material& material : tracer.frame().materials) stores_.push_back(may_have_lambert(material));
}

/// The k nearest, or all within max_radius.
PointDensity::Disc PointDensity::find(Vec3 position, Vec3 normal, NeighbourList& found) const {
  if (!facing_.any_near(position, normal, kMinCos)) return {};
  const PhotonQuery query{position, normal, options_.max_radius, kMinCos, kFlattening, kAllKinds};
  index_.find_nearest(query, options_.neighbours, found);
  if (found.count() == 0) return {};
  if (int(found.count()) < options_.neighbours) return {options_.max_radius, found.count()};
  const std::size_t farthest = found.farthest();
  return {std::sqrt(found.distance2()[farthest]), farthest};
}

/// For radii closer than coordinates can tell.
Rgb PointDensity::plain(Vec3 position, Vec3 normal, float& radius, NeighbourList& found) const {
  const IrradianceOptions options{.neighbours = options_.neighbours,
                                  .max_radius = options_.max_radius,
                                  .min_cos = kMinCos,
                                  .flattening = kFlattening};
  const IrradianceEstimate estimate = estimate_irradiance(index_, position, normal, options, found);
  radius = estimate.radius;
  return Rgb(estimate.irradiance);
}

Rgb PointDensity::estimate(const IrradiancePoint& point, const PathRandom& random, float& radius) const {
  thread_local NeighbourList found;
  const auto [found_radius, farthest] = find(point.position, point.normal, found);
  radius = float(found_radius);
  if (radius == 0) return Rgb(0.0f);
  if (!(radius > 4 * reach_.offset())) return plain(point.position, point.normal, radius, found);
  const bool whole = open_and_flat(point, radius, random.get1(2, Purpose::points));
  // In a whole disc what lies in its plane can be reached; a sheet close above it may still be another
  // side's.
  const auto counts = [&](std::uint32_t photon) {
    const Vec3 place = index_.position(photon);
    return (whole && std::abs(dot(place - point.position, point.normal)) < 4 * reach_.offset()) ||
           reach_(point.position, point.normal, place, index_.normal(photon));
  };
  Rgbd flux{0.0};
  bool any = false;
  for (std::size_t i = 0; i < found.count(); ++i) {
    const std::uint32_t photon = found.photons()[i];
    if (i == farthest || !counts(photon)) continue;
    flux += Rgbd(index_.flux(photon));
    any = true;
  }
  if (!any) return Rgb(0.0f);
  const double inverse =
      whole ? 1 / (double(kPi) * double(radius) * double(radius))
            : inverse_area(point, radius, options_.area_probes, Kernel::flat, random);
  return Rgb(Rgbd{std::max(0.0, flux.r), std::max(0.0, flux.g), std::max(0.0, flux.b)} * inverse);
}

Rgb PointDensity::estimate_sampled(Vec3 position, Vec3 normal, const PathRandom& random, float& radius) const {
  thread_local NeighbourList found;
  const auto [found_radius, farthest] = find(position, normal, found);
  radius = found_radius > 0 ? float(found_radius) : options_.max_radius;
  if (!(found_radius > 0)) return Rgb(0.0f);
  if (!(radius > 4 * reach_.offset())) return plain(position, normal, radius, found);

  struct Weighted {
    std::uint32_t photon;
    double weight;   // of the kernel: its mean over the disc is 1
  };
  thread_local std::vector<Weighted> photons;
  photons.clear();
  const auto flux_of = [&](const Weighted& w) { return Rgbd(index_.flux(w.photon)) * w.weight; };
  Rgbd all{0.0};
  for (std::size_t i = 0; i < found.count(); ++i) {
    if (i == farthest) continue;
    photons.push_back({found.photons()[i], 2 * std::max(0.0, 1 - found.distance2()[i] / (found_radius * found_radius))});
    all += flux_of(photons.back());
  }
  const std::size_t n = photons.size(), first = std::min(n, kFirstTested);
  const auto reached = [&](const Weighted& w) {
    return reach_(position, normal, index_.position(w.photon), index_.normal(w.photon));
  };
  bool open = true;
  for (std::size_t i = 0; i < first && open; ++i) {   // drawn without replacement [Fisher & Yates]
    const std::size_t drawn = i + std::size_t(random.get1(std::uint32_t(i), Purpose::gather) * float(n - i));
    std::swap(photons[i], photons[std::min(drawn, n - 1)]);
    open = reached(photons[i]);
  }
  Rgbd flux = all;
  if (!open) {
    flux = Rgbd{0.0};
    std::size_t out = 0;
    for (const Weighted& w : photons)
      if (reached(w)) flux += flux_of(w);
      else ++out;
    if (out == n) return Rgb(0.0f);
    double none = 1;
    for (std::size_t i = 0; i < first; ++i) none *= std::max(0.0, double(n - i) - double(out)) / double(n - i);
    flux = (flux - all * none) / (1 - none);
  }
  const IrradiancePoint point{position, normal};
  const double inverse = inverse_area(point, radius, open ? kProbesIfOpen : options_.area_probes, Kernel::round, random);
  return Rgb(Rgbd{std::max(0.0, flux.r), std::max(0.0, flux.g), std::max(0.0, flux.b)} * inverse);
}

/// Is the disc whole: can every place on its rim be reached across the plane, and is surface there? Sixteen
/// places miss walls that cut off less than 0.4 % of the disc.
bool PointDensity::open_and_flat(const IrradiancePoint& point, float radius, float turn) const {
  const Frame frame(point.normal);
  const Vec3 start = point.position + point.normal * (2 * reach_.offset());
  const float down = 2 * reach_.offset() + std::max(4 * reach_.offset(), kFlat * radius);
  for (int i = 0; i < kRim; ++i) {
    const float phi = 2 * kPi * (float(i) + turn) / float(kRim);
    const Vec3 rim = start + (frame.tangent * std::cos(phi) + frame.bitangent * std::sin(phi)) * radius;
    Hit hit;
    if (!reach_.free(start, rim) || !tracer_.intersect({rim, -point.normal, 0, down, true}, hit) ||
        !stores_[tracer_.frame().surfaces[hit.surface].material])
      return false;
  }
  return true;
}

/// 1 / area that can be reached, 1/m^2; 0 if there is none. Columns along the normal are drawn over the disc
/// until a fixed number m of them arrives: the mean of (number drawn) / m is exactly 1 / (share that arrives) if they
/// are independent [inverse binomial sampling, Haldane 1945], where m / (a fixed number drawn) would be too small in
/// the mean. Spread evenly they are less noisy, but the mean is low by up to 1 / (2 m): m arrive as soon as m - 1/2 are
/// to be expected. So for the flat kernel they are spread, for look-ups that are averaged they are independent. With the
/// round kernel the area counts by its weight, which is what the columns are drawn by: density 2 (1 - d^2) / pi.
double PointDensity::inverse_area(const IrradiancePoint& point, float radius, int probes, Kernel kernel,
                                  const PathRandom& random) const {
  const Frame frame(point.normal);
  const std::uint64_t key = random.bits(1, Purpose::points);
  const bool round = kernel == Kernel::round;
  int arrived = 0, drawn = 0;
  double surface = 0;  // m^2 per m^2 of the disc, summed
  while (arrived < probes && drawn < kMostProbes * probes) {
    const auto i = std::uint32_t(drawn++);
    Vec2 d = sample_disc_concentric(round ? random.get2(i, Purpose::place) : sobol_owen_2d(i, key));
    if (round) {
      const float uniform = std::min(1.0f, d.x * d.x + d.y * d.y), inward = 1 / std::sqrt(1 + std::sqrt(1 - uniform));
      d = {d.x * inward, d.y * inward};   // d^2 = 1 - sqrt(1 - uniform)
    }
    const float height = radius / kFlattening * std::sqrt(std::max(0.0f, 1 - d.x * d.x - d.y * d.y));
    const float here = column(point, (frame.tangent * d.x + frame.bitangent * d.y) * radius, height,
                              round ? random.get1(i, Purpose::place, 1) : 0);
    arrived += here > 0;
    surface += double(here);
  }
  if (arrived == 0) return 0;
  return double(drawn) / (double(kPi) * double(radius) * double(radius) * surface);
}

/// Surface that can be reached in a column from `height` above the plane to as much below it, `across` from
/// the point, over the column's section: sum of 1 / cos of the surfaces' tilts. For the round kernel they count with the
/// probability of its weight there over its weight in the plane, 1 - (h / height)^2 at h from it, by `u` of [0, 1): weights
/// themselves, which differ from column to column, would make the inverse of their sum too large. Flat kernel: u = 0.
float PointDensity::column(const IrradiancePoint& point, Vec3 across, float height, float u) const {
  const float half = std::max(4 * reach_.offset(), height);
  Vec3 top = point.position + across + point.normal * half;
  float left = 2 * half, sum = 0;
  for (int i = 0; i < kMostInColumn && left > 0; ++i) {
    Hit hit;
    if (!tracer_.intersect({top, -point.normal, 0, left, true}, hit)) break;
    const SurfacePoint there = tracer_.surface_point(hit);
    const float side = dot(there.normal_geometric, point.normal), cosine = std::abs(side);
    const Vec3 up = side < 0 ? -there.normal_geometric : there.normal_geometric;
    const float off_plane = dot(there.position - point.position, point.normal);
    if (cosine > kMinCos && stores_[there.material] && off_plane * off_plane <= (1 - u) * half * half &&
        reach_(point.position, point.normal, there.position, up))
      sum += 1 / cosine;
    const float step = hit.t + 4 * reach_.offset();
    top = top - point.normal * step;
    left -= step;
  }
  return sum;
}

}  // namespace tempolux
