#include "lib/render/camera_view.h"

namespace tempolux {

CameraView::CameraView(const PlacedCamera& camera, Vec3d origin, int width, int height)
    : camera_(camera),
      camera_from_scene_(inverse(camera.scene_from_camera)),
      origin_(origin),
      width_(width),
      height_(height) {
  half_height_ = orthographic() ? camera.camera.ymag_m : std::tan(camera.camera.yfov_rad / 2);
  half_width_ = half_height_ * width / height;
  centre_x_ = 2 * half_height_ * camera.camera.lens_shift[0];
  centre_y_ = 2 * half_height_ * camera.camera.lens_shift[1];
}

Ray CameraView::pinhole(Vec2 raster) const {
  const double px = centre_x_ + (2.0 * double(raster.x) / width_ - 1) * half_width_;
  const double py = centre_y_ + (1 - 2.0 * double(raster.y) / height_) * half_height_;
  const Affine& from = camera_.scene_from_camera;
  if (orthographic()) return {Vec3(from.point({px, py, 0})), Vec3(normalize(from.direction({0, 0, -1}))), 0, INFINITY};
  return {Vec3(from.translation), Vec3(normalize(from.direction({px, py, -1}))), 0, INFINITY};
}

std::optional<std::array<double, 2>> CameraView::project(Vec3 point) const {
  const Vec3d p = camera_from_scene_.point(Vec3d(point));
  double x = p.x, y = p.y;
  if (!orthographic()) {
    if (!(p.z < 0)) return std::nullopt;
    x /= -p.z;
    y /= -p.z;
  }
  return std::array{((x - centre_x_) / half_width_ + 1) * width_ / 2,
                    (1 - (y - centre_y_) / half_height_) * height_ / 2};
}

double CameraView::depth(Vec3 point) const { return -camera_from_scene_.point(Vec3d(point)).z; }

std::array<double, 16> CameraView::world_to_camera() const {
  const auto& m = camera_from_scene_.row;
  const Vec3d t = camera_from_scene_.translation - camera_from_scene_.direction(origin_);
  return {m[0].x, m[1].x, -m[2].x, 0, m[0].y, m[1].y, -m[2].y, 0, m[0].z, m[1].z, -m[2].z, 0, t.x, t.y, -t.z, 1};
}

std::array<double, 16> CameraView::world_to_ndc() const {
  const std::array<double, 16> c = world_to_camera();
  std::array<double, 16> ndc{};
  // Perspective: w = z, so NDC depth is 1 (there are no clipping planes). Orthographic: w = 1, so NDC depth is z.
  for (std::size_t row = 0; row < 4; ++row) {
    const double x = c[row * 4], y = c[row * 4 + 1], z = c[row * 4 + 2], w = orthographic() ? c[row * 4 + 3] : z;
    ndc[row * 4] = ((x - centre_x_ * w) / half_width_ + w) / 2;
    ndc[row * 4 + 1] = (w - (y - centre_y_ * w) / half_height_) / 2;
    ndc[row * 4 + 2] = z;
    ndc[row * 4 + 3] = w;
  }
  return ndc;
}

CameraRays::CameraRays(const Tracer& tracer, const CameraView& view, std::span<const Vec2> raster)
    : hits(raster.size()) {
  for (const Vec2 at : raster) rays.push_back(view.pinhole(at));
  tracer.intersect(rays, hits);
}

}  // namespace tempolux
