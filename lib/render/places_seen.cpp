#include "lib/render/places_seen.h"

#include <optional>

#include "lib/core/frame.h"
#include "lib/core/parallel.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/material/seen_side.h"
#include "lib/render/known_light.h"

namespace tempolux {

SeenPlaces places_seen(const RenderScene& scene, const CameraView& view, int looks, std::uint64_t seed) {
  const auto count = std::size_t(looks);
  SeenPlaces seen{std::vector<SeenPlace>(count), std::vector<SeenPlace>(count)};
  parallel_chunks(count, 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const PathRandom random(seed ^ 0x6c6561726e000001ull, i);
      const Vec2 u = sobol_owen_2d(std::uint32_t(i), seed ^ 0x6c6f6f6bull);
      const Look look{u.x * float(view.width()), u.y * float(view.height()), random};
      const std::optional<SeenPoint> point = seen_through(scene.tracer, view, look);
      if (!point) continue;
      SeenPlace& place = seen.places[i];
      const Vec3 front = point->surface.normal_geometric;
      place = {point->surface, point->normal, dot(front, point->normal) < 0 ? -front : front, false};
      const Vec3 travel = Frame(place.normal).to_world(sample_hemisphere_cos(random.get2(0, Purpose::test)));
      if (!(dot(travel, place.geometric) > 0)) continue;
      Hit hit;
      place.open = !scene.tracer.intersect(spawn_ray(place.surface, travel), hit);
      if (place.open) continue;
      const SurfacePoint met = scene.tracer.surface_point(hit);
      const SeenSide side(met, -travel);
      seen.beyond[i] = {met, side.normal, side.normal_geometric, false};
    }
  });
  return seen;
}

}  // namespace tempolux
