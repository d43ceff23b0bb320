#include "lib/render/camera_records.h"

#include <algorithm>
#include <optional>

#include "lib/gather/world_records.h"
#include "lib/render/camera_view.h"
#include "lib/render/known_light.h"
#include "lib/scene/moving_objects.h"
#include "lib/scene/static_scene.h"

namespace tempolux {
namespace {

/// A place is a gap if its weights add up to less than kGapWeight min_weight. With a factor of 1 every barely covered
/// place would get a record that depends on a pixel.
constexpr float kGapWeight = 0.5f;

/// Inputs for the placement of records.
struct Placement {
  const FinalGather& gather;
  const Tracer& tracer;
  PlacementOptions options;
  std::function<bool(const SeenPoint&)> takes;  ///< decides whether a point gets a record; empty: every point does
  const RecordSource* source = nullptr;         ///< makes records in gaps; null: `gather` does
  WorldRecords::RayShare share;                 ///< of the rays of records of the world
};

/// Calls body(number, view) for each of the frames; view finds the seen points that may get records.
template <class Body>
void for_each_camera(const Placement& place, const RecordCameras& cameras, const Body& body) {
  for (const int number : cameras.frames) {
    const SceneFrame frame = cameras.at(number);
    const CameraView view(frame, cameras.camera_node, cameras.width, cameras.height);
    body(number, [&](const Look& look) {
      std::optional<SeenPoint> seen = seen_through(place.tracer, view, look);
      if (seen && place.takes && !place.takes(*seen)) seen.reset();
      return seen;
    });
  }
}

/// Covers the places that the records of the world leave open.
void close_gaps(const Placement& place, const RecordCameras& cameras, std::span<const WantedPoint> gaps,
                RecordStore& store, GatherCounts& counts) {
  PlacementOptions options = place.options;
  options.min_weight *= kGapWeight;
  for_each_camera(place, cameras, [&](int number, const PixelView& view) {
    std::vector<SeenPoint> points;
    for (const WantedPoint& gap : std::ranges::equal_range(gaps, number, {}, &WantedPoint::frame))
      if (const auto seen = view(gap.where(cameras.width))) points.push_back(*seen);
    cover_points(place.gather, place.source, options, points, store, counts);
  });
}

GatherCounts place_for_all(const Placement& place, const RecordCameras& cameras, RecordStore& store) {
  GatherCounts counts;
  WorldRecords world(place.gather, place.tracer, place.options);
  const auto advance = [&](double done) {
    if (cameras.progress) cameras.progress(done);
  };
  double looked = 0;
  for_each_camera(place, cameras, [&](int number, const PixelView& view) {
    world.want(wanted_points(view, number, cameras.width, cameras.height));
    advance(0.2 * ++looked / double(cameras.frames.size()));
  });
  world.choose(counts);
  advance(0.5);
  world.gather(place.share, store, counts);
  advance(0.9);
  close_gaps(place, cameras, world.gaps(store, place.options.min_weight * kGapWeight), store, counts);
  return counts;
}

}  // namespace

GatherCounts place_for_cameras(const FinalGather& gather, const Tracer& tracer, const RecordCameras& cameras,
                               const PlacementOptions& options, RecordStore& store) {
  return place_for_all({gather, tracer, options, {}, nullptr, {}}, cameras, store);
}

GatherCounts update_for_cameras(const UpdateInput& input, const RecordCameras& cameras, const PlacementOptions& options,
                                LocalisedRecords& cache) {
  cache.changes = record_changes(cache.standing, input.changes, input.points, input.seed);
  const InfluenceField field(cache.standing, cache.changes, input.influence);
  const MovingObjects moving(input.tracer.frame());
  const auto on_mover = [&](const SeenPoint& seen) { return moving.contains(seen.surface.object); };
  // The picture holds f E_y (LocalisedLight), so the squared error of E_y counts f^2 times. A record with f times the
  // rays has 1 / f times the squared error. So its error in the picture is f^2 / f = f <= 1 times that of a record with
  // all rays.
  const auto share = [&](const SeenPoint& seen) {
    return on_mover(seen) ? 1.0f : field.gathered_share(seen.surface.position, seen.normal);
  };
  const RecordSource source{[&](const SeenPoint& seen, std::size_t, GatherCounts& local) {
    IrradianceRecord record = input.gather.gather(seen.surface, seen.normal, local, share(seen));
    limit_radius(record, seen.footprint, options);
    input.gather.look_around(seen.surface, record);
    return record;
  }};
  const auto matters = [&](const SeenPoint& seen) {
    return on_mover(seen) || field.gathered_share(seen.surface.position, seen.normal) > 0;
  };
  RecordStore store;
  const GatherCounts counts =
      place_for_all({input.gather, input.tracer, options, matters, &source, share}, cameras, store);
  cache.gathered.assign(store.records().begin(), store.records().end());
  cache.least_cosine = store.least_cosine();
  return counts;
}

}  // namespace tempolux
