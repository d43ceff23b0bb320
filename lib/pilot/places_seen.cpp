#include "lib/pilot/places_seen.h"

#include <algorithm>
#include <optional>

#include "lib/core/frame.h"
#include "lib/core/parallel_each.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/material/seen_side.h"
#include "lib/render/known_light.h"
#include "lib/transport/learn_sky.h"

namespace tempolux {
namespace {

constexpr float kNearEnough = 1 - 1e-3f;  ///< a hit before this share of the distance to a place hides the place

/// True if the place [scene space] lies in the picture and no surface hides it.
bool sees(const Tracer& tracer, const CameraView& view, Vec3 place) {
  const auto at = view.project(place);
  if (!at || !((*at)[0] >= 0 && (*at)[0] < view.width() && (*at)[1] >= 0 && (*at)[1] < view.height())) return false;
  Ray ray = view.pinhole({float((*at)[0]), float((*at)[1])});
  ray.t_max = kNearEnough * dot(place - ray.origin, ray.direction);
  return !tracer.occluded(ray);
}

}  // namespace

double new_share(const Tracer& tracer, std::span<const PlacedCamera> cameras, int width, int height) {
  std::vector<CameraView> views;
  double all = 0, fresh = 0;
  for (const PlacedCamera& camera : cameras) {
    const CameraView view(camera, tracer.frame().origin, width, height);
    for (std::uint32_t i = 0; i < kPlacesOfEye && !views.empty(); ++i) {
      const Vec2 u = sobol_owen_2d(i, 0);
      const Look look{u.x * float(width), u.y * float(height), {}};
      const std::optional<SeenPoint> point = seen_through(tracer, view, look);
      if (!point || !sees(tracer, view, point->surface.position)) continue;
      all += 1;
      fresh += std::ranges::none_of(
          views, [&](const CameraView& before) { return sees(tracer, before, point->surface.position); });
    }
    views.push_back(view);
  }
  return all > 0 ? fresh / all : 0;
}

SeenPlaces places_seen(const RenderScene& scene, const CameraView& view, int looks, std::uint64_t seed) {
  const auto count = std::size_t(looks);
  SeenPlaces seen{std::vector<SeenPlace>(count), std::vector<SeenPlace>(count)};
  parallel_each(count, 64, [&](std::size_t i) {
    const PathRandom random(seed ^ 0x6c6561726e000001ull, i);
    const Vec2 u = sobol_owen_2d(std::uint32_t(i), seed ^ 0x6c6f6f6bull);
    const Look look{u.x * float(view.width()), u.y * float(view.height()), random};
    const std::optional<SeenPoint> point = seen_through(scene.tracer, view, look);
    if (!point) return;
    SeenPlace& place = seen.places[i];
    const Vec3 front = point->surface.normal_geometric;
    place = {point->surface, dot(front, point->normal) < 0 ? -front : front, point->normal};
    const Vec3 travel = Frame(place.normal).to_world(sample_hemisphere_cos(random.get2(0, Purpose::test)));
    if (!(dot(travel, place.geometric) > 0)) return;
    Hit hit;
    if (!scene.tracer.intersect(spawn_ray(place.surface, travel), hit)) return;
    const SurfacePoint met = scene.tracer.surface_point(hit);
    const SeenSide side(met, -travel);
    seen.next_places[i] = {met, side.normal_geometric, side.normal};
  });
  return seen;
}

Lights guided_lights(const RenderScene& scene, const CameraView& view) {
  if (!scene.lights.has_environment()) return scene.lights;
  const SeenPlaces seen = places_seen(scene, view, int(kSkyPlaces / 2), 0);
  std::vector<SeenPlace> places;
  for (const std::vector<SeenPlace>* some : {&seen.places, &seen.next_places})
    for (const SeenPlace& place : *some)
      if (place.exists()) places.push_back(place);
  return scene.lights.guided(learn_sky(scene.tracer, scene.lights, places));
}

}  // namespace tempolux
