// lib/render/camera_view.h -- pixels to rays and points to pixels.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/material/surface_material.h"
#include "lib/scene/at_frame.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// One sample of the camera's measurement: where a ray passes the picture and the lens. Shutter draws its time.
struct CameraSample {
  Vec2 raster;            ///< raster coordinates
  Vec2 lens{0.5f, 0.5f};  ///< place on the lens as two numbers in [0, 1); (.5, .5) is its centre
};

/// A camera with a picture size in pixels, at least 1 x 1. Pixel (0, 0) is the top left one. Raster coordinates grow
/// right and down; the centre of pixel (x, y) is at (x + .5, y + .5). The vertical field of view is the camera's; the
/// horizontal one follows from the picture's aspect. A lens shift moves the picture off the view axis.
class CameraView {
 public:
  /// `origin`: world-space position of the scene space's origin [m] (SceneFrame::origin).
  CameraView(const PlacedCamera& camera, Vec3d origin, int width, int height);
  /// The camera of a node (Scene::camera_node) at the frame's time. Throws as SceneFrame::camera.
  CameraView(const SceneFrame& frame, int camera_node, int width, int height)
      : CameraView(frame.camera(camera_node), frame.origin, width, height) {}

  int width() const { return width_; }
  int height() const { return height_; }
  const PlacedCamera& camera() const { return camera_; }

  /// The ray of a sample in scene space, with a unit direction, at the moment of this view (Shutter). Perspective rays
  /// start at the sample's point of the lens, or at the eye of a pinhole; orthographic rays start on the plane through
  /// the eye.
  ///
  /// Thin lens: all rays of a raster position meet in one point of the plane of focus, on the pinhole ray [Cook,
  /// Porter, Carpenter, Distributed Ray Tracing, 1984]. The circle of confusion of a point at depth z has the diameter
  /// 2 lens_radius() |z - focus| / (z focus) in the picture at distance 1.
  Ray ray(const CameraSample& sample) const { return has_lens() ? through_lens(sample) : pinhole(sample.raster); }
  /// The ray through the lens' centre and a raster position, for what has one ray by definition: data channels,
  /// reprojection, splats.
  Ray pinhole(Vec2 raster) const;
  /// The pinhole ray of a pixel's centre.
  Ray middle(int x, int y) const { return pinhole({float(x) + 0.5f, float(y) + 0.5f}); }
  /// Raster position of a scene-space point, which may lie outside the picture. Empty if a perspective camera does not
  /// have the point in front; an orthographic camera projects every point.
  std::optional<std::array<double, 2>> project(Vec3 point) const;
  /// Raster position at which the point is seen through a point of the lens (CameraSample::lens); as project() without
  /// lens.
  std::optional<std::array<double, 2>> project(Vec3 point, Vec2 lens) const;
  /// Distance [m] of a scene-space point along the view axis; negative behind the camera. The channel Z.
  double depth(Vec3 point) const;

  /// Width [m] of a pixel at this distance [m] from the camera.
  float pixel_size(float distance) const {
    const double at_one = 2 * half_height_ / height_;
    return float(orthographic() ? at_one : at_one * double(distance));
  }

  bool orthographic() const { return camera_.camera.kind == Camera::Kind::orthographic; }
  /// True if rays start all over a lens: the picture of things off the plane of focus is blurred.
  bool has_lens() const { return lens_radius_ > 0; }
  /// m; 0: a pinhole. lens / (2 f-stop), where the camera has no radius of its own.
  double lens_radius() const { return lens_radius_; }
  /// A point of the lens in scene space.
  Vec3 lens_point(Vec2 lens) const;
  /// Diameter [pixels] of the circle of confusion of a point at this depth [m]; 0 without lens.
  double blur(double depth) const;
  /// Position of the camera in scene space.
  Vec3 eye() const { return Vec3(camera_.scene_from_camera.translation); }

  /// The cone around a pixel's ray, which decides the level of textures.
  RayCone cone() const { return orthographic() ? RayCone{pixel_size(0), 0} : RayCone{0, pixel_size(1)}; }

  /// OpenEXR's standard attributes, from world space: row-vector matrices, row-major. Camera space is left-handed,
  /// +x right, +y up, +z into the picture. NDC is (0, 0) at the top left and (1, 1) at the bottom right of the picture.
  std::array<double, 16> world_to_camera() const;
  std::array<double, 16> world_to_ndc() const;

 private:
  Ray through_lens(const CameraSample& sample) const;
  Vec2 on_lens(Vec2 lens) const;
  /// x, y: in the picture at distance 1 (perspective), or in m (orthographic).
  std::array<double, 2> raster_of(double x, double y) const;
  /// The place of a raster position in the picture at distance 1: the inverse of raster_of.
  std::array<double, 2> in_picture(Vec2 raster) const;

  PlacedCamera camera_;
  Affine camera_from_scene_;
  Vec3d origin_;
  int width_, height_;
  // Of the picture: at distance 1 (perspective), or in m (orthographic).
  double half_width_, half_height_;
  double centre_x_, centre_y_;  ///< of the picture, from the view axis: to the right, up
  double lens_radius_ = 0;      ///< m
  double per_focus_ = 0;        ///< 1/m: 1 / distance of the plane of focus; 0: infinitely far, or not known
};

/// A sample of pixel (x, y). Its places in the pixel and on the lens are the numbers of Purpose::pixel and
/// Purpose::lens of `random` (PathRandom or PixelRandom).
template <class Random>
CameraSample sample_of_pixel(const CameraView& view, int x, int y, const Random& random) {
  const Vec2 within = random.get2(0, Purpose::pixel);
  CameraSample sample{.raster = {float(x) + within.x, float(y) + within.y}};
  if (view.has_lens()) sample.lens = random.get2(0, Purpose::lens);
  return sample;
}

/// Rays of a camera and what they meet first.
struct CameraRays {
  std::vector<Ray> rays;
  std::vector<Hit> hits;  ///< by ray; surface kNone: nothing

  /// The pinhole rays through these raster positions, in their order.
  CameraRays(const Tracer& tracer, const CameraView& view, std::span<const Vec2> raster);
};

}  // namespace tempolux
