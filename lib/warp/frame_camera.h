// lib/warp/frame_camera.h -- a frame's camera from its standard EXR attributes: projects points to pixels and back.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "lib/core/affine.h"
#include "lib/image/image.h"

namespace tempolux {

/// A position in a picture.
struct RasterPoint {
  double x = 0, y = 0;  ///< pixels, y down; pixel centres at +0.5
};

/// A camera with a picture size. Camera space is that of the EXR attribute worldToCamera: +x right, +y up, +z into the
/// picture, so z is the channel Z. Any projection that maps lines to lines is allowed: perspective, orthographic,
/// shifted.
class FrameCamera {
 public:
  /// The matrices are the attributes worldToCamera and worldToNDC of formats/frames/frames.md. Throws
  /// std::invalid_argument if one of them is not invertible.
  FrameCamera(const std::array<double, 16>& world_to_camera, const std::array<double, 16>& world_to_ndc, int width,
              int height);

  int width() const { return width_; }
  int height() const { return height_; }
  const Affine& camera_from_world() const { return camera_from_world_; }
  const Affine& world_from_camera() const { return world_from_camera_; }
  /// Position of the camera in world space. For an orthographic camera, a point of the plane whose depth is 0.
  Vec3d eye() const { return world_from_camera_.translation; }

  /// Position of a point (camera space). Nothing if the point is not in front of a perspective camera.
  std::optional<RasterPoint> project(Vec3d point) const {
    const double w = dot(w_, point) + w_shift_;
    if (!(w > 0)) return std::nullopt;
    return RasterPoint{(dot(x_, point) + x_shift_) / w, (dot(y_, point) + y_shift_) / w};
  }
  /// Position of a point at infinity in this direction (camera space).
  std::optional<RasterPoint> project_direction(Vec3d direction) const {
    const double w = dot(w_, direction);
    if (!(w > 0)) return std::nullopt;
    return RasterPoint{dot(x_, direction) / w, dot(y_, direction) / w};
  }
  /// The point (camera space) at position `at` and this depth.
  Vec3d unproject(RasterPoint at, double depth) const {
    if (!axes_apart_) return solve(at, depth);
    const double w = w_.z * depth + w_shift_;
    return {(at.x * w - x_.z * depth - x_shift_) * per_x_, (at.y * w - y_.z * depth - y_shift_) * per_y_, depth};
  }
  /// The direction (camera space, z = 1) in which a perspective camera sees the position.
  Vec3d direction(RasterPoint at) const { return unproject(at, 1); }

  /// True if distant objects look as large as close ones.
  bool orthographic() const { return w_.z == 0; }
  /// Area of the surface that a pixel shows, m^2 times a constant of this picture. Point p and normal n are in camera
  /// space. For a perspective camera the area is d^2 cos^3 g / c = z^3 / |n . p|, with the distance d, the cosine c
  /// between ray and normal, and the angle g between ray and axis.
  double area_of_pixel(Vec3d point, Vec3d normal) const {
    const double area = pixel_width_ * pixel_width_;
    if (orthographic()) return area / std::max(std::abs(normal.z), 1e-3);
    return area * point.z * point.z * point.z / std::max(std::abs(dot(normal, point)), 1e-3 * length(point));
  }
  /// |n . r|: cosine between the normal of a surface and its ray; point and normal are in camera space.
  double facing(Vec3d point, Vec3d normal) const {
    return orthographic() ? std::abs(normal.z) : std::abs(dot(normal, point)) / length(point);
  }
  /// Width of a pixel, m: at depth 1 (perspective) or at any depth (orthographic).
  double pixel_width() const { return pixel_width_; }

  bool operator==(const FrameCamera&) const = default;

 private:
  Vec3d solve(RasterPoint at, double depth) const;

  int width_, height_;
  Affine camera_from_world_, world_from_camera_;
  // Raster position = (x . p + x_shift, y . p + y_shift) / (w . p + w_shift), p in camera space.
  Vec3d x_, y_, w_;
  double x_shift_ = 0, y_shift_ = 0, w_shift_ = 0;
  double pixel_width_ = 0;
  /// True if raster x depends only on x and depth, and raster y only on y and depth: unproject() then solves no
  /// equations.
  bool axes_apart_ = false;
  double per_x_ = 0, per_y_ = 0;
};

/// The camera from a frame's attributes. Throws InputError, beginning with `name`, if an attribute is missing or not
/// invertible.
FrameCamera camera_of(const Image& image, const std::string& name);

}  // namespace tempolux
