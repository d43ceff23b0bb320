#include "lib/transport/learn_sky.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "lib/core/frame.h"
#include "lib/core/parallel_each.h"
#include "lib/core/pi.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/transport/media.h"

namespace tempolux {
namespace {

/// Rays of a place: first by the cosine, then as many by what the first ones have found (docs/methods/lights.md).
constexpr std::uint32_t kRays = 4;
/// Places send twice as many first rays, up to kMostRays, while some rays meet the environment, but fewer than a grid
/// on each of six sides needs.
constexpr std::size_t kFewestHits = 6 * SkyGuide::kSearchHits;
constexpr std::uint32_t kMostRays = 64;
/// If the first rays make fewer hits than one for kFew places, more rays search. Windows of a usual size make more
/// hits.
constexpr std::size_t kFew = 16;
constexpr std::uint64_t kSeed = 0x736b79;

/// Learns at places by passes of rays (learn_sky).
class SkyLearner {
 public:
  SkyLearner(const Tracer& tracer, const Lights& lights, std::span<const SeenPlace> places)
      : tracer_(tracer), lights_(lights), places_(places) {
    senders_.resize(places.size());
    parallel_each(places.size(), 64, [&](std::size_t i) {
      senders_[i] = {places[i].surface.position, places[i].normal, lamps_at(places[i], i)};
    });
  }

  std::shared_ptr<const SkyGuide> learn() {
    send(nullptr, kRays);
    while (!hits_.empty() && hits_.size() < kFewestHits && sent() < kMostRays) send(nullptr, sent());
    if (hits_.size() < places_.size() / kFew) search();
    else follow(guide_for(SkyGuide::Use::light));
    return guide_for(SkyGuide::Use::light);
  }

 private:
  /// Sends rays by guides of all hits so far, until there are as many hits as places, or until rays find no more than
  /// those before.
  void search() {
    std::size_t found = 0;
    for (std::size_t before = hits_.size(); hits_.size() < places_.size(); before = hits_.size()) {
      if (!follow(guide_for(SkyGuide::Use::search)) || hits_.size() - before <= found) break;
      found = hits_.size() - before;
    }
  }

  /// Sends kRays rays from each place by the guide. False if the guide has no grid.
  bool follow(std::shared_ptr<const SkyGuide> guide) {
    if (!guide->has_grids()) return false;
    send(std::move(guide), kRays);
    return true;
  }

  /// Measures SkyGuide::Place::lamps by one light sample.
  float lamps_at(const SeenPlace& at, std::uint64_t place) const {
    const PathRandom random(kSeed, place);
    LightSample light;
    double unshadowed = 0, irradiance = 0;
    if (lights_.sample_placed(at.surface.position, at.normal, random.get2(0, Purpose::light_point), light,
                              unshadowed) &&
        dot(light.wi, at.normal) > 0 && dot(light.wi, at.geometric) > 0) {
      const Ray shadow = spawn_shadow_ray(at.surface, light.position, light.position_offset);
      irradiance = max_component(light.facing_irradiance * transmittance(tracer_, shadow, {random, 0, way_shadow})) *
                   dot(light.wi, at.normal);
    }
    return unshadowed > 0 ? float(irradiance * irradiance / (unshadowed * unshadowed)) : -1;
  }

  /// Rays of every place that are drawn by the grids of a guide, or by the cosine where it has none.
  struct Pass {
    std::shared_ptr<const SkyGuide> guide;  ///< nullptr: by the cosine everywhere
    std::uint32_t rays = 0;

    const SkyGuide::Grid* grid_at(const SeenPlace& from) const {
      return guide ? guide->grid_of(guide->at(from.surface.position, from.normal)) : nullptr;
    }
  };

  std::uint32_t sent() const {
    std::uint32_t rays = 0;
    for (const Pass& pass : passes_) rays += pass.rays;
    return rays;
  }

  /// Sends `rays` more rays from each place and keeps their hits, in the order of places.
  void send(std::shared_ptr<const SkyGuide> guide, std::uint32_t rays) {
    const Pass pass{std::move(guide), rays};
    const std::uint32_t begin = sent();
    const std::vector<SkyGuide::Hit> found =
        parallel_found<SkyGuide::Hit>(places_.size(), 64, [&](std::size_t i, std::vector<SkyGuide::Hit>& hits) {
          const SeenPlace& from = places_[i];
          const SkyGuide::Grid* const grid = pass.grid_at(from);
          for (std::uint32_t ray = begin; ray < begin + rays; ++ray) {
            const Vec2 u = PathRandom(kSeed, i).get2(ray, Purpose::scatter);
            const Vec3 travel =
                grid ? grid->sample(double(u.x), double(u.y)) : Frame(from.normal).to_world(sample_hemisphere_cos(u));
            if (const float radiance = radiance_of(from, i, ray, travel); radiance > 0)
              hits.push_back({std::uint32_t(i), travel, 1, radiance});
          }
        });
    std::vector<SkyGuide::Hit> all;
    std::ranges::merge(hits_, found, std::back_inserter(all), {}, &SkyGuide::Hit::place, &SkyGuide::Hit::place);
    hits_ = std::move(all);
    passes_.push_back(pass);
  }

  /// Radiance of the environment that a ray of a place meets, largest channel.
  float radiance_of(const SeenPlace& from, std::uint64_t place, std::uint32_t ray, Vec3 travel) const {
    if (!(dot(travel, from.geometric) > 0 && dot(travel, from.normal) > 0)) return 0;
    const Rgb passed =
        transmittance(tracer_, spawn_ray(from.surface, travel), {PathRandom(kSeed, place), ray, way_shadow});
    return max_component(passed * lights_.environment(travel));
  }

  /// A guide of all hits. Each hit counts with cos / pi over the mean pdf of all rays of its place.
  std::shared_ptr<const SkyGuide> guide_for(SkyGuide::Use use) const {
    std::vector<SkyGuide::Hit> weighted = hits_;
    const double all = sent();
    parallel_each(weighted.size(), 64, [&](std::size_t i) {
      SkyGuide::Hit& hit = weighted[i];
      const SeenPlace& from = places_[hit.place];
      const double cosine = double(dot(hit.direction, from.normal)) / kPiD;
      double pdf = 0;
      for (const Pass& pass : passes_) {
        const SkyGuide::Grid* const grid = pass.grid_at(from);
        pdf += pass.rays / all * (grid ? grid->pdf_solid_angle(hit.direction) : cosine);
      }
      hit.share = float(cosine / pdf);
      hit.weight *= hit.share;
    });
    return std::make_shared<const SkyGuide>(senders_, std::move(weighted), int(sent()), use);
  }

  const Tracer& tracer_;
  const Lights& lights_;
  std::span<const SeenPlace> places_;
  std::vector<SkyGuide::Place> senders_;
  std::vector<Pass> passes_;
  std::vector<SkyGuide::Hit> hits_;  ///< in the order of places; weight: radiance, share: 1
};

}  // namespace

std::shared_ptr<const SkyGuide> learn_sky(const Tracer& tracer, const Lights& lights,
                                          std::span<const SeenPlace> places) {
  if (!lights.has_environment()) return nullptr;
  return SkyLearner(tracer, lights, places).learn();
}

}  // namespace tempolux
