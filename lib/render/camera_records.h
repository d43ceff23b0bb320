// lib/render/camera_records.h -- places irradiance records where the cameras of frames need them, and updates static
// records.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lib/gather/localised_file.h"
#include "lib/gather/place_records.h"

namespace tempolux {

/// Cameras for which records are placed. All frames must have the same light and objects.
struct RecordCameras {
  std::vector<int> frames;
  int camera_node = 0;
  int width = 640, height = 360;  ///< of the pictures, pixels
  /// Returns the scene at a frame; may throw, for example if the light differs from that of the first frame.
  std::function<SceneFrame(int frame)> at;
  std::function<void(double done)> progress;  ///< called with [0, 1]; may be empty
};

/// Adds every record that any of the cameras needs to `store` and returns the counts. The records are valid while
/// nothing but the camera changes. Same records for any number of threads.
GatherCounts place_for_cameras(const FinalGather& gather, const Tracer& tracer, const RecordCameras& cameras,
                               const PlacementOptions& options, RecordStore& store);

/// Inputs of localised gathering. All references must stay valid during the call.
struct UpdateInput {
  const FinalGather& gather;
  const Tracer& tracer;  ///< the scene at the frame
  const PointLookup& points;
  /// Densities of dynamic maps: first the frame's own map, then those of frames before (record_changes).
  std::span<const SignedDensity> changes;
  InfluenceThresholds influence;
  std::uint64_t seed = 0;  ///< of the estimates of changes
};

/// Estimates by how much movers change each static record in cache.standing. Gathers new records where a camera sees a
/// mover, or a place where the movers' influence is above the lower threshold. Sets cache.changes, gathered and
/// least_cosine, and returns the counts. Same records for any number of threads.
GatherCounts update_for_cameras(const UpdateInput& input, const RecordCameras& cameras, const PlacementOptions& options,
                                LocalisedRecords& cache);

}  // namespace tempolux
