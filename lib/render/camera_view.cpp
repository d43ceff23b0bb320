#include "lib/render/camera_view.h"

#include <algorithm>
#include <cmath>

#include "lib/core/sampling.h"

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
  if (!camera.camera.has_lens()) return;
  lens_radius_ = tempolux::lens_radius(camera.camera, std::max(half_width_, half_height_));
  per_focus_ = camera.camera.focus_m > 0 ? 1 / camera.camera.focus_m : 0;
}

Vec2 CameraView::on_lens(Vec2 lens) const {
  const Vec2 on = sample_disc_concentric(lens);
  return {on.x * float(lens_radius_), on.y * float(lens_radius_)};
}

Vec3 CameraView::lens_point(Vec2 lens) const {
  if (!has_lens()) return eye();
  const Vec2 on = on_lens(lens);
  return Vec3(camera_.scene_from_camera.point({double(on.x), double(on.y), 0}));
}

std::array<double, 2> CameraView::in_picture(Vec2 raster) const {
  return {centre_x_ + (2.0 * double(raster.x) / width_ - 1) * half_width_,
          centre_y_ + (1 - 2.0 * double(raster.y) / height_) * half_height_};
}

/// From the point l of the lens to the point focus (p, -1) of the plane of focus, where p is the raster position in the
/// picture at distance 1: the direction is (p - l / focus, -1), also for an infinite focus.
Ray CameraView::through_lens(const CameraSample& sample) const {
  const auto [px, py] = in_picture(sample.raster);
  const Vec2 on = on_lens(sample.lens);
  const double lx = double(on.x), ly = double(on.y);
  const Affine& from = camera_.scene_from_camera;
  return {Vec3(from.point({lx, ly, 0})),
          Vec3(normalize(from.direction({px - lx * per_focus_, py - ly * per_focus_, -1}))), 0, INFINITY};
}

double CameraView::blur(double depth) const {
  if (!has_lens() || !(depth > 0)) return 0;
  return 2 * lens_radius_ * std::abs(per_focus_ - 1 / depth) / (2 * half_height_ / height_);
}

Ray CameraView::pinhole(Vec2 raster) const {
  const auto [px, py] = in_picture(raster);
  const Affine& from = camera_.scene_from_camera;
  if (orthographic()) return {Vec3(from.point({px, py, 0})), Vec3(normalize(from.direction({0, 0, -1}))), 0, INFINITY};
  return {Vec3(from.translation), Vec3(normalize(from.direction({px, py, -1}))), 0, INFINITY};
}

std::optional<std::array<double, 2>> CameraView::project(Vec3 point) const {
  const Vec3d p = camera_from_scene_.point(Vec3d(point));
  if (orthographic()) return raster_of(p.x, p.y);
  if (!(p.z < 0)) return std::nullopt;
  return raster_of(p.x / -p.z, p.y / -p.z);
}

std::optional<std::array<double, 2>> CameraView::project(Vec3 point, Vec2 lens) const {
  if (!has_lens()) return project(point);
  const Vec3d p = camera_from_scene_.point(Vec3d(point));
  if (!(p.z < 0)) return std::nullopt;
  const Vec2 on = on_lens(lens);
  const double lx = double(on.x), ly = double(on.y);
  return raster_of((p.x - lx) / -p.z + lx * per_focus_, (p.y - ly) / -p.z + ly * per_focus_);
}

std::array<double, 2> CameraView::raster_of(double x, double y) const {
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
