// lib/render/choose_split.h -- is much of the light that lights what is seen in a few bright spots? Told by a pilot.
#pragma once

#include <cstdint>
#include <string>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// What a pilot saw of light on surfaces, as rays by the cosine from places that a camera sees meet it.
struct SplitPilot {
  /// Variance of the radiance that such rays meet, over what it is without the light that photonmap-split takes out of
  /// bright cells; 1 where it takes nothing.
  double variance_ratio = 1;
  double high_share = 0;  ///< of the radiance that the rays meet: what is taken out
};

/// 2^16 photon paths of all kinds in cells (FluxCells, the default limit), 2048 places seen and a ray from each: a
/// tenth of a second. Same result for any number of threads.
SplitPilot pilot_split(const SceneFrame& frame, const EmissionTable& emission, const CameraView& view,
                       std::uint64_t seed);

struct SplitChoice {
  bool split = false;
  std::string because;
};

/// A split pays where the variance falls to less than half: explicit samples cost up to half of what rays cost
/// (docs/methods/split.md has the measurements).
SplitChoice choose_split(const SplitPilot& pilot);

}  // namespace tempolux
