// lib/render/choose_preview.h -- how many paths of light a preview starts for a frame, and how wide its light textures
// are smoothed.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "lib/render/path_tracer.h"

namespace tempolux {

/// What a pilot of photons finds in a frame.
struct PreviewPilot {
  double photons = 0;  ///< of a path
  double area = 0;     ///< m^2, of all surfaces, one side
};
/// Photons of these kinds (photon-trace --kinds) that 32768 paths leave. The same result for any number of threads.
PreviewPilot pilot_preview(const RenderScene& scene, const std::string& kinds, std::uint64_t seed);

struct PreviewChoice {
  std::uint64_t paths = 0;  ///< of a frame
  double width = 0;         ///< m: deviation of the Gaussian where windows are full
};
/// Paths that bring so many photons in a frame, at least as many and at most 16 times as many paths, as photon_paths()
/// has it; means over the pilots, as all frames of a segment have the same elements. `frames`: of a full window.
PreviewChoice choose_preview(std::span<const PreviewPilot> pilots, std::uint64_t photons, int frames);

}  // namespace tempolux
