// lib/render/choose_split.h -- a pilot decides whether much of the light comes from a few bright spots
// (photonmap-split).
#pragma once

#include <cstdint>
#include <string>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// What a pilot measures of the light that gather rays from visible places meet.
struct SplitPilot {
  /// Variance of the radiance that gather rays meet, divided by the variance without the light that photonmap-split
  /// takes out of bright cells. 1 if photonmap-split takes out nothing.
  double variance_ratio = 1;
  double high_share = 0;  ///< the share of the radiance that is taken out
};

/// Traces kPilotPaths light paths, sums their photons of all kinds in cells (FluxCells, the default limit), and sends
/// one gather ray from each of 2048 visible places. Takes a tenth of a second. Same result for any number of threads.
SplitPilot pilot_split(const SceneFrame& frame, const EmissionTable& emission, const CameraView& view,
                       std::uint64_t seed);

struct SplitChoice {
  bool split = false;
  std::string because;
};

/// Decides for a split if the variance falls below half: explicit samples cost up to half as much as the rays
/// (docs/methods/split.md has the measurements).
SplitChoice choose_split(const SplitPilot& pilot);

}  // namespace tempolux
