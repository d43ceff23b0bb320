// tests/support/chain.h -- a scene with its photons, points and gathered records, made in memory.
#pragma once

#include <gtest/gtest.h>

#include "lib/points/irradiance_points.h"
#include "lib/gather/place_records.h"
#include "tests/support/photons.h"
#include "tests/support/pixel_views.h"
#include "tests/support/scenes.h"

namespace tempolux::test {

struct Traced {
  std::vector<formats::Photon> photons;
  double stored_indirect = 0;  ///< W, green
};

inline Traced trace(const Tracer& tracer, const Lights& lights, std::uint64_t count) {
  PhotonOptions options;
  options.photon_count = count;
  options.store_direct = false;
  const PhotonTracer photons(tracer, lights, options);
  Traced traced;
  for (const formats::Photon& photon : test::photons_of(photons)) {
    traced.photons.push_back(photon);
    traced.stored_indirect += double(photon.flux[1]);
  }
  return traced;
}

/// A scene with its photons, points and a gather.
struct Chain {
  const SceneFrame& frame;
  EmissionTable table;
  Tracer tracer;
  Lights lights;
  Traced traced;
  PointOptions point_options;
  PlacedPoints placed;
  PointLookup lookup;
  FinalGather gather;
  RecordStore store;

  Chain(HandMadeScene& scene, std::uint64_t photons, std::uint32_t point_count, int rays, int light_samples = 4)
      : frame(scene.frame()),
        table(build_emission_table({&frame, 1})),
        tracer(frame),
        lights(frame, table),
        traced(trace(tracer, lights, photons)),
        point_options(counted(point_count, light_samples)),
        placed(estimated()),
        lookup(placed.points, placed.spacing, point_clearance(tracer)),
        gather(tracer, lights, lookup, with_rays(rays)),
        store() {}

  /// Places records for a picture. at(i) is the place that pixel i sees, and the normal of the side from which it is
  /// seen.
  template <class At>
  void place(int width, int height, float footprint, const At& at) {
    GatherCounts counts;
    const PixelView views = pixel_by_pixel([&](float x, float y, const PathRandom*) -> std::optional<SeenPoint> {
      const std::optional<std::pair<SurfacePoint, Vec3>> seen =
          at(std::uint32_t(y) * std::uint32_t(width) + std::uint32_t(x));
      if (!seen) return std::nullopt;
      return SeenPoint{seen->first, seen->second, footprint, false};
    });
    place_records(gather, {views, width, height}, {}, store, counts);
    EXPECT_LT(counts.unanswered, counts.rays / 20);  // near walls and bends of a surface some hits have no point
  }
  /// The surface that a ray meets which starts h above `position` and runs against `normal`.
  std::optional<std::pair<SurfacePoint, Vec3>> surface_at(Vec3 position, Vec3 normal, float h) const {
    Hit hit;
    if (!tracer.intersect({position + normal * h, -normal}, hit)) return std::nullopt;
    return std::pair{tracer.surface_point(hit), normal};
  }

 private:
  static PointOptions counted(std::uint32_t count, int light_samples) {
    PointOptions options;
    options.count = count;
    options.light_samples = light_samples;
    return options;
  }
  static GatherOptions with_rays(int rays) {
    GatherOptions options;
    options.rays = rays;
    return options;
  }
  PlacedPoints estimated() {
    PlacedPoints made = place_points(frame, point_options);
    estimate_points(tracer, lights, traced.photons, {}, point_options, made.points);
    return made;
  }
};

}  // namespace tempolux::test
