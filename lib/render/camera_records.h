// lib/render/camera_records.h -- irradiance records where the cameras of frames need them, gathered or updated from
// static records.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lib/gather/localised_file.h"
#include "lib/gather/place_records.h"

namespace tempolux {

/// Cameras for which records are placed, one after the other. All frames have the same light and the same objects.
struct RecordCameras {
  std::vector<int> frames;
  int camera_node = 0;
  int width = 640, height = 360;  ///< of the pictures, pixels
  /// The scene at a frame; throws InputError if its light differs from that of the first.
  std::function<SceneFrame(int frame)> at;
  std::function<void(double done)> progress;
  std::function<void(int frame, std::size_t records)> added;
};

/// Places records for all cameras in one store. They are valid while nothing but the camera changes.
GatherCounts place_for_cameras(const FinalGather& gather, const Tracer& tracer, const RecordCameras& cameras,
                               const PlacementOptions& options, RecordStore& store);

/// Inputs of localised gathering.
struct UpdateInput {
  const FinalGather& gather;
  const Tracer& tracer;  ///< the scene at the frame
  const PointLookup& points;
  /// The frame's dynamic maps relative to the static scene; first the frame's own map.
  std::span<const SignedDensity> changes;
  InfluenceThresholds influence;
  std::uint64_t seed = 0;
};

/// Updates the static records in `cache` and gathers new ones where movers change the light that the cameras see.
/// Returns the counts and sets least_cosine.
GatherCounts update_for_cameras(const UpdateInput& input, const RecordCameras& cameras, const PlacementOptions& options,
                                LocalisedRecords& cache);

}  // namespace tempolux
