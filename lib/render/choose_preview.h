// lib/render/choose_preview.h -- how many light paths a preview starts for a frame, and how wide its light textures are
// smoothed.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "formats/photons/photons.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// What a pilot of photons measures in a frame.
struct PreviewPilot {
  double photons = 0;  ///< photons that a light path leaves, mean
  double area = 0;     ///< area of all surfaces, one side [m^2]
};
/// Traces kPilotPaths light paths and counts the photons of these kinds (photon-trace --kinds). Same result for any
/// number of threads.
PreviewPilot pilot_preview(const RenderScene& scene, const std::string& kinds, std::uint64_t seed);

/// Number of photons under the Gaussian that smooths one of two equal photon maps with the least error. Maps a and b
/// are counted in elements. Irradiance E_a, smoothed by each candidate, is judged by the other map's flux F_b: over
/// elements of area A,
///
///     sum (A E_a^2 - 2 E_a F_b) / E
///
/// is the squared error of E_a plus a constant (cross-validation; Bowman, Biometrika 71(2), 1984). The weight 1 / E is
/// nearly the squared slope of a display's tone curve. Positions are in scene space. 256 if a map is empty.
double best_kernel(const Tracer& tracer, std::span<const formats::Photon> a, std::span<const formats::Photon> b);

/// best_kernel() of two maps of kPilotPaths light paths.
double pilot_kernel(const RenderScene& scene, const std::string& kinds, std::uint64_t seed);

struct PreviewChoice {
  std::uint64_t paths = 0;  ///< light paths per frame
  double width = 0;         ///< m: standard deviation of the Gaussian, for full windows
};
/// The number of light paths that leaves `photons` photons in a frame: at least `photons` paths and at most 16 times as
/// many, in the steps of photon_paths(). Uses means over all pilots, because all frames of a segment share their
/// elements. `kernel`: of pilot_kernel(). `frames`: number of frames in a full window.
PreviewChoice choose_preview(std::span<const PreviewPilot> pilots, double kernel, std::uint64_t photons, int frames);

}  // namespace tempolux
