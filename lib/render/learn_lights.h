// lib/render/learn_lights.h -- learns by rays what light from far away reaches the places that cameras see.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lib/light/light_grid.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Of the rays from what is seen at most this share leaves the scene where anything is learned: rooms with windows
/// below, streets above it.
inline constexpr double kMostOpen = 0.1;

struct LearnOptions {
  std::uint64_t seed = 0;
  int looks = 4096;  ///< eye rays, dealt out to the views; each goes on for one bounce
  int rays = 128;    ///< of a cell, of each of two passes, at most: one for each 450 pixels
};

/// A grid for what views of the scene (one at least) see and, less densely, for what that sees. Its cells are a
/// twentieth of what is seen wide (2nd to 98th percentile along the longest axis), most_cells at most: those most
/// looked at. Same grid for any number of threads. nullptr where there is no light from far away, nothing is seen, or
/// more than a tenth of the rays from there leave the scene: there is little to learn then. docs/pixels.md says how
/// shares are made of rays.
std::unique_ptr<LightGrid> learn_lights(const RenderScene& scene, std::span<const CameraView> views,
                                        const LearnOptions& options);

}  // namespace tempolux
