#include "lib/transport/learn_sky.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "lib/core/frame.h"
#include "lib/core/parallel_each.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/transport/media.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kRays = 4;  ///< of a place (figures: docs/methods/lights.md)
constexpr std::uint64_t kSeed = 0x736b79;

/// Appends the rays of place `number` that see the environment, weighed by the radiance that arrives.
void add_hits(const Tracer& tracer, const Lights& lights, const SeenPlace& from, std::uint32_t number,
              std::vector<SkyGuide::Hit>& hits) {
  const Frame axes(from.normal);
  const PathRandom random(kSeed, number);
  for (std::uint32_t i = 0; i < kRays; ++i) {
    const Vec3 travel = axes.to_world(sample_hemisphere_cos(random.get2(i, Purpose::scatter)));
    if (!(dot(travel, from.geometric) > 0)) continue;
    const Rgb passed = transmittance(tracer, spawn_ray(from.surface, travel), {random, i, way_shadow});
    const float weight = max_component(passed * lights.environment(travel));
    if (weight > 0) hits.push_back({number, travel, weight});
  }
}

}  // namespace

std::shared_ptr<const SkyGuide> learn_sky(const Tracer& tracer, const Lights& lights,
                                          std::span<const SeenPlace> places) {
  if (!lights.has_environment()) return nullptr;
  std::vector<SkyGuide::Hit> hits =
      parallel_found<SkyGuide::Hit>(places.size(), 64, [&](std::size_t i, std::vector<SkyGuide::Hit>& found) {
        add_hits(tracer, lights, places[i], std::uint32_t(i), found);
      });
  std::vector<SkyGuide::Place> senders;
  for (const SeenPlace& place : places) senders.push_back({place.surface.position, place.normal});
  auto guide = std::make_shared<const SkyGuide>(senders, std::move(hits), int(kRays));
  return guide->empty() ? nullptr : guide;
}

}  // namespace tempolux
