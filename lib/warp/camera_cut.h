// lib/warp/camera_cut.h -- finds camera cuts: frames between which the picture jumps.
#pragma once

#include <vector>

#include "lib/warp/frame_camera.h"
#include "lib/warp/seen_surfaces.h"

namespace tempolux {

/// Points (world space) that a frame shows, on a grid of at most 32 x 32 pixels; without points at infinity.
std::vector<Vec3d> grid_of_points(const SeenSurfaces& seen, const FrameCamera& camera);

/// True if most of the points that `before` shows move by more than a quarter of the picture's width, or out of the
/// picture, until `after`. At 24 frames a second and a field of view of 60 degrees this is 360 degrees a second; eyes
/// follow up to 80. False if `before` shows none of the points.
bool is_cut(const std::vector<Vec3d>& points, const FrameCamera& before, const FrameCamera& after);

}  // namespace tempolux
