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
constexpr std::uint64_t kSeed = 0x736b79;

/// Learns at places by two passes of rays (learn_sky).
class SkyLearner {
 public:
  SkyLearner(const Tracer& tracer, const Lights& lights, std::span<const SeenPlace> places)
      : tracer_(tracer), lights_(lights), places_(places) {
    senders_.resize(places.size());
    parallel_each(places.size(), 64, [&](std::size_t i) {
      senders_[i] = {places[i].surface.position, places[i].normal, lamps_at(places[i], i)};
    });
  }

  std::shared_ptr<const SkyGuide> learn() const {
    std::vector<SkyGuide::Hit> first = hits_by_cosine(), all;
    auto guide = std::make_shared<const SkyGuide>(senders_, first, int(kRays));
    if (!guide->has_grids()) return guide;
    const std::vector<SkyGuide::Hit> second = hits_by(*guide);
    weigh_anew(*guide, first);
    std::ranges::merge(first, second, std::back_inserter(all), {}, &SkyGuide::Hit::place, &SkyGuide::Hit::place);
    return std::make_shared<const SkyGuide>(senders_, std::move(all), int(2 * kRays));
  }

 private:
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

  template <class Add>
  std::vector<SkyGuide::Hit> hits(const Add& add) const {
    return parallel_found<SkyGuide::Hit>(places_.size(), 64, [&](std::size_t i, std::vector<SkyGuide::Hit>& found) {
      add(places_[i], std::uint32_t(i), found);
    });
  }

  /// Appends a ray if it sees the environment. `share`: cos / pi over its pdf.
  void add(const SeenPlace& from, std::uint32_t place, std::uint32_t ray, Vec3 travel, float share,
           std::vector<SkyGuide::Hit>& found) const {
    if (!(dot(travel, from.geometric) > 0)) return;
    const Rgb passed =
        transmittance(tracer_, spawn_ray(from.surface, travel), {PathRandom(kSeed, place), ray, way_shadow});
    const float weight = max_component(passed * lights_.environment(travel)) * share;
    if (weight > 0) found.push_back({place, travel, share, weight});
  }

  static Vec3 by_cosine(const SeenPlace& from, std::uint32_t place, std::uint32_t ray) {
    const PathRandom random(kSeed, place);
    return Frame(from.normal).to_world(sample_hemisphere_cos(random.get2(ray, Purpose::scatter)));
  }

  std::vector<SkyGuide::Hit> hits_by_cosine() const {
    return hits([&](const SeenPlace& from, std::uint32_t place, std::vector<SkyGuide::Hit>& found) {
      for (std::uint32_t i = 0; i < kRays; ++i) add(from, place, i, by_cosine(from, place, i), 1, found);
    });
  }

  const SkyGuide::Grid* grid_at(const SkyGuide& guide, const SeenPlace& from) const {
    return guide.grid_of(guide.at(from.surface.position, from.normal));
  }

  /// cos / pi over the pdf of both passes together. grid: of the place; null: both passes drew by the cosine.
  static float share_of(const SkyGuide::Grid* grid, const SeenPlace& from, Vec3 travel) {
    const double cosine = std::max(0.0f, dot(travel, from.normal)) / kPiD;
    if (!(cosine > 0)) return 0;
    return grid ? float(2 * cosine / (cosine + grid->pdf_solid_angle(travel))) : 1;
  }

  /// The second pass: rays by the grids of the first pass, or by the cosine where there is no grid.
  std::vector<SkyGuide::Hit> hits_by(const SkyGuide& guide) const {
    return hits([&](const SeenPlace& from, std::uint32_t place, std::vector<SkyGuide::Hit>& found) {
      const SkyGuide::Grid* const grid = grid_at(guide, from);
      const PathRandom random(kSeed, place);
      for (std::uint32_t i = kRays; i < 2 * kRays; ++i) {
        const Vec2 u = random.get2(i, Purpose::scatter);
        const Vec3 travel = grid ? grid->sample(double(u.x), double(u.y)) : by_cosine(from, place, i);
        add(from, place, i, travel, share_of(grid, from, travel), found);
      }
    });
  }

  /// Gives the hits of the first pass the weights that they have beside the second.
  void weigh_anew(const SkyGuide& guide, std::vector<SkyGuide::Hit>& first) const {
    for (SkyGuide::Hit& hit : first) {
      const SeenPlace& from = places_[hit.place];
      hit.share = share_of(grid_at(guide, from), from, hit.direction);
      hit.weight *= hit.share;
    }
    std::erase_if(first, [](const SkyGuide::Hit& hit) { return !(hit.weight > 0); });
  }

  const Tracer& tracer_;
  const Lights& lights_;
  std::span<const SeenPlace> places_;
  std::vector<SkyGuide::Place> senders_;
};

}  // namespace

std::shared_ptr<const SkyGuide> learn_sky(const Tracer& tracer, const Lights& lights,
                                          std::span<const SeenPlace> places) {
  if (!lights.has_environment()) return nullptr;
  return SkyLearner(tracer, lights, places).learn();
}

}  // namespace tempolux
