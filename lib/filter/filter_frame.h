// lib/filter/filter_frame.h -- a frame filtered in space and time where the halves of its samples show that it pays.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "lib/filter/collect.h"
#include "lib/filter/fit.h"
#include "lib/filter/left_noise.h"
#include "lib/filter/light.h"

namespace tempolux {

/// Fits in space. The large windows take what small ones have found that do not overlap, and reach 7 pixels.
inline constexpr FitOptions kSmall{2, 1, false}, kSmallAlike{2, 1, true}, kLarge{1, 5, false};
inline constexpr int kMostScales = 2;

struct FilterOptions {
  int scales = kMostScales;  ///< 1: small windows alone; 0: filter in time alone
  std::map<std::string, float>
      dark;  ///< by layer dark_of() the whole picture (choose.h); without: of the image at hand
};

/// A frame of a window: its light, and the first fits of its matte light.
struct WindowLight {
  int width, height;
  FrameLight light;
  std::optional<BothHalves> guides;  ///< none without matte light, nor for a frame that is filtered alone
  WindowLight(const Image& image, bool alone);
};

/// Filters a frame with those around it. Each half of the light is fitted by itself at each scale (fit.h), alone and
/// with what was collected along the flow (collect.h); which pixels count is decided by the other half. Each candidate
/// is put together at edges where `image` has coverage (unmix.h, resolve.h) and multiplied by albedo again. choose()
/// mixes them with the raw layer. R G B is the sum of the layers, and what it held beside them. Other channels and all
/// attributes stay.
class FrameFilter {
 public:
  /// middle: made of the image; middle and flow outlive this. before, after: frames of the window.
  FrameFilter(const WindowLight& middle, const FlowFrame& flow, std::size_t before, std::size_t after,
              const FilterOptions& options);
  ~FrameFilter();
  FrameFilter(const FrameFilter&) = delete;
  FrameFilter& operator=(const FrameFilter&) = delete;

  /// The frames of the window in the order in which they are followed: the `before` ones, the nearest first, then the
  /// `after` ones. None is looked at after the call. InputError if it differs from the middle's in size or layers.
  void add(const WindowLight& frame, const FlowFrame& flow);
  /// Once, after all were added. The image says what noise is left (tell_left_noise in left_noise.h).
  Image finish(Image image);
  /// The same of a part of a picture, whose attributes stay.
  void filter(Image& image);
  /// After either: by pixel (left_noise.h); empty where nothing was filtered.
  LeftError left_error() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same without frames around, tile by tile: little memory beside the image's. The same bytes as FrameFilter's but
/// for rounding.
Image filter_alone(Image image, const FilterOptions& options);

}  // namespace tempolux
