// lib/warp/key_frame.h -- a key frame: a rendered frame from which other frames are warped.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/warp/frame_camera.h"
#include "lib/warp/seen_surfaces.h"

namespace tempolux {

inline constexpr std::size_t kMostChannels = 64;  ///< colour channels in a key

/// A key's colour and surfaces, laid out for look-ups.
class KeyFrame {
 public:
  /// Copies the image's colour (RGBA and LAYER.R .G .B), its depth and, if there, objects and normals. Albedo is left
  /// out, because the target computes it from its own surfaces; variance, because interpolation changes it. Throws
  /// InputError, beginning with `name`.
  KeyFrame(const Image& image, const std::string& name, const FrameCamera& camera);

  const std::string& name() const { return name_; }
  const FrameCamera& camera() const { return camera_; }
  const SeenSurfaces& seen() const { return seen_; }
  /// True if the pixel shows a single face (whole_pixels()).
  bool whole(std::size_t pixel) const { return whole_[pixel] != 0; }
  /// Depth, object and normal of one pixel.
  const FacePoint& shown(std::size_t pixel) const { return shown_[pixel]; }
  /// Channel names as in frames, in ascending order.
  const std::vector<std::string>& colour_names() const { return names_; }
  /// Values of a pixel in the order of colour_names(), then zeros up to stride().
  const float* colour(std::size_t pixel) const { return colour_.get() + pixel * stride_; }
  /// Floats from one pixel to the next: a multiple of 8, so that vector loops have no remainder.
  std::size_t stride() const { return stride_; }

 private:
  std::string name_;
  FrameCamera camera_;
  SeenSurfaces seen_;
  std::vector<std::uint8_t> whole_;
  std::vector<FacePoint> shown_;
  std::vector<std::string> names_;
  std::size_t stride_ = 0;
  std::unique_ptr<float[]> colour_;
};

}  // namespace tempolux
