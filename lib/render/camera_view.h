// lib/render/camera_view.h -- pixels to rays and points to pixels.
#pragma once

#include <array>
#include <optional>

#include "lib/material/surface_material.h"
#include "lib/scene/at_frame.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A camera with a picture size. Pixel (0, 0) is the top left one; raster coordinates grow right and down,
/// pixel centres at +0.5. The vertical field of view is the camera's; the width follows the picture's aspect.
class CameraView {
 public:
  CameraView(const PlacedCamera& camera, Vec3d origin, int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  const PlacedCamera& camera() const { return camera_; }

  /// The ray through raster position (x, y), scene space; perspective rays start at the eye, orthographic ones
  /// on the plane through it. Direction is unit.
  Ray ray(float x, float y) const;
  /// Raster position of a scene-space point; nothing if it is not in front of the camera.
  std::optional<std::array<double, 2>> project(Vec3 point) const;
  /// Distance along the view axis, m: the Z channel.
  double depth(Vec3 point) const;

  /// Size of a pixel at this distance from the camera, m.
  float pixel_size(float distance) const {
    const double at_one = 2 * half_height_ / height_;
    return float(camera_.camera.kind == Camera::Kind::perspective ? at_one * double(distance) : at_one);
  }

  bool orthographic() const { return camera_.camera.kind == Camera::Kind::orthographic; }
  /// Where the camera is, scene space.
  Vec3 eye() const { return Vec3(camera_.scene_from_camera.translation); }

  /// The cone around a pixel's ray, which decides the level of textures.
  RayCone cone() const {
    return camera_.camera.kind == Camera::Kind::perspective ? RayCone{0, pixel_size(1)} : RayCone{pixel_size(0), 0};
  }

  /// OpenEXR's standard attributes: row-vector matrices, row-major. Camera space is left-handed, +x right, +y up,
  /// +z into the picture; NDC is (0, 0) at the top left and (1, 1) at the bottom right of the picture.
  std::array<double, 16> world_to_camera() const;
  std::array<double, 16> world_to_ndc() const;

 private:
  PlacedCamera camera_;
  Affine camera_from_scene_;
  Vec3d origin_;
  int width_, height_;
  double half_width_, half_height_;  ///< of the view plane at distance 1 (perspective) or anywhere, m (orthographic)
};

}  // namespace tempolux
