// lib/render/learn_lights.h -- learns with rays which distant light reaches the places that cameras see.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lib/light/light_grid.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Nothing is learned if more than this share of the rays from visible places leave the scene. Rooms with windows lie
/// below this limit, streets above it.
inline constexpr double kMostOpen = 0.1;

struct LearnOptions {
  std::uint64_t seed = 0;
  int looks = 4096;  ///< camera rays, distributed over the views; each continues for one bounce
  int rays = 128;    ///< largest number of rays per cell in each of two passes; one per 450 pixels of the picture
};

/// A grid for the places that the views see (at least one view) and, less densely, for the places that these places
/// see. A cell is a twentieth as wide as the visible places (2nd to 98th percentile along the longest axis); at most
/// most_cells cells, those that hold most places. Same grid for any number of threads. Returns nullptr if there is no
/// distant light, if nothing is seen, or if more than a tenth of the rays leave the scene, where there is little to
/// learn. docs/pixels.md derives the shares from the rays.
std::unique_ptr<LightGrid> learn_lights(const RenderScene& scene, std::span<const CameraView> views,
                                        const LearnOptions& options);

}  // namespace tempolux
