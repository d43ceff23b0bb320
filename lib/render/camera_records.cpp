#include "lib/render/camera_records.h"

#include <algorithm>
#include <optional>

#include "lib/render/camera_view.h"
#include "lib/render/known_light.h"
#include "lib/scene/moving_objects.h"
#include "lib/scene/static_scene.h"

namespace tempolux {
namespace {

/// Factor of PlacementOptions::min_weight for the cameras of all frames but the first. With the full min_weight, a
/// later frame would get new records all over the picture, at all places that records of earlier frames barely cover.
constexpr float kLaterWeight = 0.5f;

/// Inputs for the placement of records.
struct Placement {
  const FinalGather& gather;
  const Tracer& tracer;
  PlacementOptions options;
  std::function<bool(const SeenPoint&)> takes;  ///< decides whether a point gets a record; empty: every point does
  const RecordSource* source = nullptr;         ///< makes the records; null: `gather` does
};

GatherCounts place_for_all(const Placement& place, const RecordCameras& cameras, RecordStore& store) {
  GatherCounts counts;
  for (const int number : cameras.frames) {
    const SceneFrame frame = cameras.at(number);
    const CameraView view(frame, cameras.camera_node, cameras.width, cameras.height);
    const auto look_at = [&](const Look& look) {
      std::optional<SeenPoint> seen = seen_through(place.tracer, view, look);
      if (seen && place.takes && !place.takes(*seen)) seen.reset();
      return seen;
    };
    PlacementOptions options = place.options;
    if (number != cameras.frames.front()) options.min_weight *= kLaterWeight;
    const std::size_t added = place_records(
        place.gather, {look_at, cameras.width, cameras.height, cameras.progress, place.source}, options, store, counts);
    cameras.added(number, added);
  }
  return counts;
}

}  // namespace

GatherCounts place_for_cameras(const FinalGather& gather, const Tracer& tracer, const RecordCameras& cameras,
                               const PlacementOptions& options, RecordStore& store) {
  return place_for_all({gather, tracer, options, {}}, cameras, store);
}

GatherCounts update_for_cameras(const UpdateInput& input, const RecordCameras& cameras, const PlacementOptions& options,
                                LocalisedRecords& cache) {
  cache.changes = record_changes(cache.standing, input.changes, input.points, input.seed);
  const InfluenceField field(cache.standing, cache.changes, input.influence);
  const MovingObjects moving(input.tracer.frame());
  const auto rides = [&](const SeenPoint& seen) { return moving.contains(seen.surface.object); };
  // The picture holds f E_y (LocalisedLight), so the squared error of E_y counts f^2 times. A record with f times the
  // rays has 1 / f times the squared error: in all f times that of a record with all rays, which is never more.
  const RecordSource source{[&](const SeenPoint& seen, std::size_t, GatherCounts& local) {
    const float share = rides(seen) ? 1.0f : field.gathered_share(seen.surface.position, seen.normal);
    IrradianceRecord record = input.gather.gather(seen.surface, seen.normal, local, share);
    limit_radius(record, seen.footprint, options);
    input.gather.look_around(seen.surface, record);
    return record;
  }};
  const auto matters = [&](const SeenPoint& seen) {
    return rides(seen) || field.gathered_share(seen.surface.position, seen.normal) > 0;
  };
  RecordStore store;
  const GatherCounts counts = place_for_all({input.gather, input.tracer, options, matters, &source}, cameras, store);
  cache.gathered.assign(store.records().begin(), store.records().end());
  cache.least_cosine = store.least_cosine();
  return counts;
}

}  // namespace tempolux
