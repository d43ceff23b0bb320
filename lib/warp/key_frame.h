// lib/warp/key_frame.h -- a rendered frame that others are warped from.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/warp/frame_camera.h"
#include "lib/warp/seen_surfaces.h"

namespace tempolux {

inline constexpr std::size_t kMostChannels = 64;  ///< of colour, in a key

/// A key's colour and what it shows, laid out for look-ups.
class KeyFrame {
 public:
  /// The image's colour layers (RGBA and LAYER.R .G .B, but not albedo, which belongs to the surface, and variance,
  /// which an interpolated value has not), depth and, if they are there, objects and normals. Throws InputError,
  /// beginning with `name`.
  KeyFrame(const Image& image, const std::string& name, const FrameCamera& camera);

  const std::string& name() const { return name_; }
  const FrameCamera& camera() const { return camera_; }
  const SeenSurfaces& seen() const { return seen_; }
  /// Whole pixels: see whole_pixels().
  bool whole(std::size_t pixel) const { return (whole_[pixel] & 1) != 0; }
  /// This pixel, the one to its right and the two below; of the last row and column false.
  bool four_whole(std::size_t pixel) const { return (whole_[pixel] & 2) != 0; }
  /// seen() of one pixel, together.
  const FacePoint& shown(std::size_t pixel) const { return shown_[pixel]; }
  /// Channels by the names that frames give them, in ascending order.
  const std::vector<std::string>& colour_names() const { return names_; }
  /// Values of a pixel in the order of colour_names(), then zeros up to stride().
  const float* colour(std::size_t pixel) const { return colour_.get() + pixel * stride_; }
  /// Floats from one pixel to the next: a multiple of 8, so that loops over them need no rest.
  std::size_t stride() const { return stride_; }

 private:
  void look_at_pixels();

  std::string name_;
  FrameCamera camera_;
  SeenSurfaces seen_;
  std::vector<std::uint8_t> whole_;  ///< 1: whole(), 2: four_whole()
  std::vector<FacePoint> shown_;
  std::vector<std::string> names_;
  std::size_t stride_ = 0;
  std::unique_ptr<float[]> colour_;
};

}  // namespace tempolux
