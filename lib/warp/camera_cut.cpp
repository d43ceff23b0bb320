#include "lib/warp/camera_cut.h"

#include <cmath>

namespace tempolux {
namespace {

/// Points per row and column. Of 32 x 32 points the share that jumps has a standard error of at most 1.6 %.
constexpr int kGrid = 32;
/// Share of the picture's width. At 24 frames a second and a field of view of 60 degrees this is 360 degrees a second.
/// Eyes follow up to 80, so no film pans as fast.
constexpr double kJump = 0.25;

bool within(const std::optional<RasterPoint>& at, const FrameCamera& camera) {
  return at && at->x >= 0 && at->y >= 0 && at->x < camera.width() && at->y < camera.height();
}

}  // namespace

std::vector<Vec3d> grid_of_points(const SeenSurfaces& seen, const FrameCamera& camera) {
  std::vector<Vec3d> points;
  const int step_x = (seen.width + kGrid - 1) / kGrid, step_y = (seen.height + kGrid - 1) / kGrid;
  for (int y = step_y / 2; y < seen.height; y += step_y)
    for (int x = step_x / 2; x < seen.width; x += step_x) {
      const float depth = seen.depth[std::size_t(y) * std::size_t(seen.width) + std::size_t(x)];
      if (depth < INFINITY)
        points.push_back(camera.world_from_camera().point(camera.unproject({x + 0.5, y + 0.5}, double(depth))));
    }
  return points;
}

bool is_cut(const std::vector<Vec3d>& points, const FrameCamera& before, const FrameCamera& after) {
  std::size_t seen = 0, jumped = 0;
  for (const Vec3d& point : points) {
    const auto was = before.project(before.camera_from_world().point(point));
    if (!within(was, before)) continue;
    ++seen;
    const auto is = after.project(after.camera_from_world().point(point));
    jumped += !within(is, after) || std::hypot(is->x - was->x, is->y - was->y) > kJump * after.width();
  }
  return 2 * jumped > seen;
}

}  // namespace tempolux
