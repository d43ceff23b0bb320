#include "lib/pilot/choose_light.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "lib/core/grid.h"
#include "lib/gather/final_gather.h"
#include "lib/pilot/spread_work.h"
#include "lib/points/irradiance_points.h"
#include "lib/render/photon_light.h"
#include "lib/render/pixel_noise.h"

namespace tempolux {
namespace {

constexpr double kPointsOfBothSides = 2.0 * PointOptions{}.count;
/// Limits of the number of gather rays of a record. Fewer distances do not determine the radius of a record;
/// irradcache-build --rays does not accept more.
constexpr double kFewestRays = FinalGather::kDistanceRays, kMostRays = 1 << 20;
constexpr double kLeastError = 1e-12;

/// Squared error of a raw frame over the squared error of the filtered frame, without the error of records: geometric
/// mean of seven scenes
/// (docs/methods/ways.md).
constexpr double kFilterGain = 2.4;
constexpr double kMapNeighbours = PhotonLightOptions{}.caustic_neighbours;

/// Squared error of the caustic light that a density of photons estimates: a density by k photons errs by 1 / sqrt(k).
double map_error(const RoughFrame& rough) {
  double square = 0;
  for (const CausticPart& part : rough.caustic) square += part.square;
  return square / kMapNeighbours;
}

/// The samples of a way (AskedPicture).
struct AskedSamples {
  double work, count, error;
};

/// Spreads the work of a way with a map in a filtered picture.
void spread(const RoughFrame& rough, const Order& order, const AskedSamples& samples, Way& way) {
  const bool records = way.method == IndirectMethod::records;
  const AskedPicture asked{.pixels = order.pixels,
                           .sample_work = samples.work,
                           .samples = samples.count,
                           .sample_error = samples.error,
                           .ray_work = records ? order.records * rough.records * rough.record_ray : 0,
                           .ray_error = records ? rough.record_error : 0,
                           .rays = way.rays,
                           .photons = order.photons,
                           .most_photons = order.most_photons,
                           .pictures = order.pictures,
                           .work = way.work};
  const SpreadWork best = spread_work(rough, asked);
  way.rays = best.rays;
  way.photons = best.photons;
  way.pixel_error = error_for_samples(best.samples);
}

/// The number k of ways_to_light(). of_pixels: P c n. `way`: work and error without the rays. If pictures share
/// records, the rays of all of them together cost at most as much as the samples of one picture, or as k for this
/// picture alone: a picture that is made alone makes all of them.
int rays_of_records(const RoughFrame& rough, const Order& order, double of_pixels, const Way& way) {
  const double ray = rough.records * rough.record_ray;
  if (!(ray > 0)) return int(kFewestRays);
  const auto best = [&](double share) {
    return std::sqrt(Seen::kRecords * rough.record_error * way.work / (share * ray * way.error));
  };
  const double most = std::max(best(1), of_pixels / ray);
  return int(nearest_on_grid(std::clamp(std::min(best(order.records), most), kFewestRays, kMostRays), 1));
}

/// Work and error of one way, with as many samples as the wish's pixel error asks for. map: visible caustic light comes
/// from photons.
Way way_of(const RoughFrame& rough, const Order& order, IndirectMethod method, bool map) {
  const bool records = method == IndirectMethod::records;
  const SampleEffort& effort = method == IndirectMethod::paths ? rough.path : rough.gather;
  const double variance = records ? (map ? effort.other_without_caustic : effort.other)
                          : map   ? effort.without_caustic
                                  : effort.all;
  const double wanted = std::max(kLeastError, rough.wanted), samples = std::max(1.0, variance / wanted);
  const double sample = (records ? rough.record_sample : effort.work) + (map ? Work::kCausticLookUp : 0);
  double fixed = 0;
  if (map || method != IndirectMethod::paths)
    fixed += double(order.photons) * Work::kRay * (1 + rough.photons_per_path);
  if (method != IndirectMethod::paths) fixed += kPointsOfBothSides * Work::kPoint;
  Way way{.method = method, .map = map, .photons = order.photons};
  const double of_pixels = order.pixels * sample * samples;
  way.work = fixed / order.pictures + of_pixels;
  const double of_samples = order.filtered ? wanted / kFilterGain : wanted;
  way.error = of_samples * (order.filtered ? Seen::kSamples : Seen::independent());
  way.measured = records ? rough.recorded : rough.gathered || method == IndirectMethod::paths;
  if (map) way.error += Seen::smooth() * map_error(rough);
  // A map holds caustic light, records indirect light; samples find the other layers.
  const MissedLight caustic = map ? MissedLight{} : effort.missed_caustic,
                    indirect = records ? MissedLight{} : effort.missed_indirect;
  way.error += Seen::smooth() * (caustic.left(samples) + indirect.left(samples));
  way.never = caustic.never;
  way.uncertain = indirect.uncertain;
  const double lone = caustic.lone + indirect.lone;
  way.error += Seen::smooth() * lone * lone;
  if (records) {
    way.work += order.records * rough.records * Work::kRecord;
    way.rays = rays_of_records(rough, order, of_pixels, way);
    way.work += order.records * rough.records * rough.record_ray * way.rays;
    way.error += Seen::kRecords * rough.record_error / way.rays;
  }
  if (order.filtered && map) spread(rough, order, {sample, samples, of_samples}, way);
  if (rough.wanted_of > 0 && variance > rough.wanted_of)
    way.pixel_error *= error_for_variance(variance / rough.wanted_of);
  way.pixel_error = nearest_on_grid(way.pixel_error, 4);
  return way;
}

/// The order of ways_to_light().
void sort(std::vector<Way>& ways) {
  std::ranges::stable_sort(ways, {},
                           [](const Way& way) { return std::pair(way.never > 0 || way.uncertain > 0, way.score()); });
}

}  // namespace

std::vector<Way> ways_to_light(const RoughFrame& rough, const Order& order, bool caustics) {
  std::vector<Way> ways;
  for (const IndirectMethod method : {IndirectMethod::paths, IndirectMethod::gather, IndirectMethod::records})
    for (const bool map : {false, true})
      if ((!map || caustics) && (method == IndirectMethod::paths || rough.places > 0))
        ways.push_back(way_of(rough, order, method, map));
  sort(ways);
  return ways;
}

std::vector<Way> joined(const std::vector<std::vector<Way>>& ways_of_frames) {
  std::vector<Way> all;
  for (const std::vector<Way>& ways : ways_of_frames)
    for (const Way& way : ways) {
      const auto same = std::ranges::find_if(
          all, [&](const Way& other) { return other.method == way.method && other.map == way.map; });
      if (same == all.end()) {
        all.push_back(way);
        continue;
      }
      same->work += way.work;
      same->error += way.error;
      same->rays = std::max(same->rays, way.rays);
      same->photons = std::max(same->photons, way.photons);
      same->pixel_error = std::min(same->pixel_error, way.pixel_error);
      same->measured &= way.measured;
      same->never = std::max(same->never, way.never);
      same->uncertain = std::max(same->uncertain, way.uncertain);
    }
  sort(all);
  return all;
}

std::string because(const std::vector<Way>& ways) {
  char text[96];
  std::string words;
  const double least = ways.front().score();
  for (const Way& way : ways) {
    std::snprintf(text, sizeof text, "%s%s %s%.3g", kIndirectMethods[std::size_t(way.method)],
                  way.map ? " beside caustics of photons" : "", way.measured ? "" : "at least ",
                  least > 0 ? way.score() / least : 1.0);
    words += (words.empty() ? "work x squared error: " : ", ") + std::string(text);
  }
  const auto most = [&](double Way::*share) { return std::ranges::max(ways, {}, share).*share; };
  if (const double never = most(&Way::never); never > 0) {
    std::snprintf(text, sizeof text, "; without caustics of photons a frame lacks %.2g %% of its light: ", 100 * never);
    words += text + std::string("what point, spot and sun lights send by mirrors and smooth glass");
  }
  if (const double uncertain = most(&Way::uncertain); uncertain > 0) {
    std::snprintf(text, sizeof text, "; paths meet %.2g %% of the light too seldom to know how much it is",
                  100 * uncertain);
    words += text;
  }
  return words;
}

}  // namespace tempolux
