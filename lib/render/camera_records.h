// lib/render/camera_records.h -- irradiance records where the cameras of frames need them: gathered, or following from
// those of what stands.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lib/gather/localised_file.h"
#include "lib/gather/place_records.h"

namespace tempolux {

/// Cameras for which records are placed, one after the other. All frames are lit and built alike.
struct RecordCameras {
  std::vector<int> frames;
  int camera_node = 0;
  int width = 640, height = 360;                               ///< of the pictures, pixels
  std::function<SceneFrame(int frame)> at;                     ///< InputError for a frame that is not lit as the first
  std::function<std::vector<std::uint8_t>(int frame)> wanted;  ///< by pixel, 0: nobody looks there; empty: all
  std::function<void(double done)> progress;
  std::function<void(int frame, std::size_t records)> added;
};

/// Records for all cameras: one store, valid while nothing but the camera changes.
GatherCounts place_for_cameras(const FinalGather& gather, const Tracer& tracer, const RecordCameras& cameras,
                               const PlacementOptions& options, RecordStore& store);

/// What localised gathering starts from.
struct UpdateInput {
  const FinalGather& gather;
  const Tracer& tracer;  ///< the scene at the frame
  const PointLookup& points;
  std::span<const SignedDensity> changes;  ///< dynamic maps of the frame, its own first, over the scene as it stands
  InfluenceThresholds influence;
  std::uint64_t seed = 0;
};

/// Changes of the standing records in `cache`, and new records where movers matter to the cameras, of which counts and
/// least_cosine are.
GatherCounts update_for_cameras(const UpdateInput& input, const RecordCameras& cameras, const PlacementOptions& options,
                                LocalisedRecords& cache);

}  // namespace tempolux
