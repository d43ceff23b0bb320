// lib/warp/camera_cut.h -- does the picture jump between two frames?
#pragma once

#include <vector>

#include "lib/warp/frame_camera.h"
#include "lib/warp/seen_surfaces.h"

namespace tempolux {

/// Points (world space) of what a frame shows, on a grid of at most 32 x 32 pixels; nothing infinitely far away.
std::vector<Vec3d> grid_of_points(const SeenSurfaces& seen, const FrameCamera& camera);

/// Do most of the points that `before` shows move by more than a quarter of the picture's width, or out of it, on the
/// way to `after`? At 24 frames a second and a field of 60 degrees that is 360 degrees a second, faster than any pan
/// that is meant to be looked at (eyes follow up to 80). False if `before` shows none of them.
bool is_cut(const std::vector<Vec3d>& points, const FrameCamera& before, const FrameCamera& after);

}  // namespace tempolux
