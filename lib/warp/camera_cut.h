// lib/warp/camera_cut.h -- finds camera cuts: frames between which the picture jumps.
#pragma once

#include <vector>

#include "lib/warp/frame_camera.h"
#include "lib/warp/seen_surfaces.h"

namespace tempolux {

/// Points (world space) that a frame shows at a grid of at most 32 x 32 pixels; pixels that show infinity are left out.
std::vector<Vec3d> grid_of_points(const SeenSurfaces& seen, const FrameCamera& camera);

/// True if from `before` to `after` most of the points that `before` shows leave the picture or move by more than a
/// quarter of its width. False if `before` shows none of the points.
bool is_cut(const std::vector<Vec3d>& points, const FrameCamera& before, const FrameCamera& after);

}  // namespace tempolux
