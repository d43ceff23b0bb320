// lib/pilot/choose_preview.h -- the number of light paths for a frame of a preview, and the width of the filter of its
// light textures.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "formats/photons/photons.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Measurements of a pilot of photons in a frame.
struct PreviewPilot {
  double photons = 0;  ///< mean number of photons that a light path leaves
  double area = 0;     ///< area of all surfaces, one side [m^2]
};
/// Traces kPilotPaths light paths and counts the photons of these kinds (photon-trace --kinds). Same result for any
/// number of threads.
PreviewPilot pilot_preview(const RenderScene& scene, const std::string& kinds, std::uint64_t seed);

/// Number of photons below the Gaussian that smooths one of two maps of equal size with the least error. The photons of
/// maps a and b are counted in elements of area A. Let E_a be the irradiance of map a, smoothed by a candidate, and F_b
/// the flux of map b. The sum over elements
///
///     sum (A E_a^2 - 2 E_a F_b) / E
///
/// is the squared error of E_a plus a constant (cross-validation; Bowman, Biometrika 71(2), 1984). The weight 1 / E,
/// with the irradiance E by a middle candidate, is nearly the squared slope of a display's tone curve. Positions are in
/// scene space. Returns 256 if a map is empty.
double best_kernel(const Tracer& tracer, std::span<const formats::Photon> a, std::span<const formats::Photon> b);

/// best_kernel() of two maps of kPilotPaths light paths, with photons of these kinds (photon-trace --kinds).
double pilot_kernel(const RenderScene& scene, const std::string& kinds, std::uint64_t seed);

struct PreviewChoice {
  std::uint64_t paths = 0;  ///< light paths per frame
  double width = 0;         ///< standard deviation of the Gaussian [m], for elements with a full window
};
/// The number of light paths that leaves `photons` photons in a frame, between `photons` and kMostTimesPhotons times as
/// many. Uses the means of the pilots (at least one), because all frames of a segment share their elements. `kernel`:
/// of pilot_kernel(). `frames`: number of frames in a full window.
PreviewChoice choose_preview(std::span<const PreviewPilot> pilots, double kernel, std::uint64_t photons, int frames);

}  // namespace tempolux
