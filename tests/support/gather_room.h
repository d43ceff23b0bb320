// tests/support/gather_room.h -- a room whose light is known, for tests of records.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lib/gather/place_records.h"
#include "tests/support/pixel_views.h"
#include "tests/support/scenes.h"

namespace tempolux::test {

/// A room of 2 m with a box in it, seen by a pinhole from its upper corner or from `eye`; every irradiance point holds
/// 1 or 3 W/m^2.
struct GatherRoom {
  HandMadeScene scene;
  std::vector<IrradiancePoint> points;
  const SceneFrame* frame;
  std::unique_ptr<Tracer> tracer;
  std::unique_ptr<Lights> lights;
  std::unique_ptr<PointLookup> lookup;
  std::unique_ptr<FinalGather> gather;

  GatherRoom() {
    scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f)));
    scene.add_room({-0.3f, -1, -0.3f}, {0.2f, -0.4f, 0.3f}, matte(Rgb(0.7f)));
    frame = &scene.frame();
    for (std::uint32_t object = 0; object < 2; ++object)
      for (Vec3 n : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
        IrradiancePoint point;
        point.position = -n;
        point.normal = n;
        point.object = object;
        point.indirect = Rgb(n.x > 0 ? 3.0f : 1.0f);
        points.push_back(point);
      }
    tracer = std::make_unique<Tracer>(*frame);
    lights = std::make_unique<Lights>(*frame, EmissionTable{});
    lookup = std::make_unique<PointLookup>(points, 2.0f);
    GatherOptions options;
    options.rays = 50;
    gather = std::make_unique<FinalGather>(*tracer, *lights, *lookup, options);
  }

  std::optional<SeenPoint> see(float x, float y, int width, int height, Vec3 eye = {0.9f, 0.7f, 0.9f}) const {
    const Vec3 forward = normalize(Vec3{-0.9f, -1, -0.9f}), right = normalize(cross(forward, Vec3{0, 1, 0})),
               up = cross(right, forward);
    const float u = 2 * x / float(width) - 1, v = 1 - 2 * y / float(height);
    const Vec3 direction = normalize(forward + right * u + up * (v * float(height) / float(width)));
    Hit hit;
    if (!tracer->intersect({eye, direction}, hit)) return std::nullopt;
    const SurfacePoint point = tracer->surface_point(hit);
    const Vec3 n = dot(point.normal, direction) > 0 ? -point.normal : point.normal;
    return SeenPoint{point, n, hit.t * 2 / float(width), false};
  }

  std::size_t place(int width, int height, RecordStore& store, GatherCounts& counts,
                    const PlacementOptions& options = {}) const {
    const PixelView views =
        pixel_by_pixel([&, width, height](float x, float y, const PathRandom*) { return see(x, y, width, height); });
    return place_records(*gather, {views, width, height}, options, store, counts);
  }
};

}  // namespace tempolux::test
