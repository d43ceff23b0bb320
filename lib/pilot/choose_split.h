// lib/pilot/choose_split.h -- a pilot decides whether much of the light comes from a few bright spots
// (photonmap-split).
#pragma once

#include <cstdint>
#include <string>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Measurements of a pilot: the light that gather rays from visible places meet.
struct SplitPilot {
  /// Variance of the radiance that gather rays meet, over the variance of its low part (photonmap-split). 1 without a
  /// high part; 1e6 if the low part has no variance.
  double variance_ratio = 1;
  double high_share = 0;  ///< the high part over the whole radiance
};

/// Traces kPilotPaths light paths, divides the light of their photons of all kinds into a low and a high part
/// (FluxCells with the limit kBrightLimit), and sends one gather ray from each of kPilotPlaces visible places. Takes a
/// tenth of a second. Same result for any number of threads.
SplitPilot pilot_split(const RenderScene& scene, const CameraView& view, std::uint64_t seed);

struct SplitChoice {
  bool split = false;
  std::string because;
};

/// Decides for a split if the variance of the low part is less than half of the whole variance, and reports the reason
/// as text. Explicit samples cost up to half as much as the rays (docs/methods/split.md has the measurements).
SplitChoice choose_split(const SplitPilot& pilot);

}  // namespace tempolux
