// lib/filter/filter_frame.h -- filters a frame in space and time where the halves of its samples show a gain.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "lib/filter/collect.h"
#include "lib/filter/fit.h"
#include "lib/filter/remaining_noise.h"
#include "lib/filter/light.h"

namespace tempolux {

/// Windows of the fits. The large window reads every fifth pixel of the result of a small window, so the small windows
/// of the pixels that it reads do not overlap. Together they reach 7 pixels.
inline constexpr FitOptions kSmall{2, 1, false}, kSmallAlike{2, 1, true}, kLarge{1, 5, false};

/// A frame of a window: its light, and the first fits of its matte light.
struct WindowLight {
  int width, height;
  FrameLight light;
  std::optional<BothHalves> guides;  ///< empty without matte light, and if the frame is filtered alone
  WindowLight(const Image& image, bool alone);
};

/// Filters a frame together with its neighbours in time. Each half of the light is fitted in small and large windows
/// (fit.h), once with its own light alone and once with the light collected along the flow (collect.h); the other half
/// decides the weights. Where `image` has coverage, edges are composed from their surfaces (unmix.h, resolve.h). Each
/// candidate is multiplied by albedo, and choose() mixes the candidates with the raw layer. R, G and B become the sum
/// of the layers plus any light that they held besides the layers. LAYER.noise becomes half the difference of the
/// layer's filtered halves. Other channels and all attributes stay.
class FrameFilter {
 public:
  /// `middle` is made from the image that finish() or filter() receives; middle and flow must outlive this object.
  /// `before` and `after` are the numbers of frames on each side of the window. `dark`: dark_of() the whole picture if
  /// the image is only a part of it (choose.h); empty: dark_of() the image.
  FrameFilter(const WindowLight& middle, const FlowFrame& flow, std::size_t before, std::size_t after,
              std::optional<float> dark = {});
  ~FrameFilter();
  FrameFilter(const FrameFilter&) = delete;
  FrameFilter& operator=(const FrameFilter&) = delete;

  /// Adds the next frame of the window: first the `before` earlier frames, then the `after` later frames, in both
  /// directions the closest first. The frame is not used after the call. Throws InputError if its size or its layers
  /// are not those of the middle frame.
  void add(const WindowLight& frame, const FlowFrame& flow);
  /// Call once, after all frames were added. Writes the remaining noise to the image's attributes
  /// (write_remaining_noise in remaining_noise.h).
  Image finish(Image image);
  /// Filters a part of a picture; its attributes do not change.
  void filter(Image& image);
  /// The squared error by pixel after finish() or filter() (remaining_noise.h); empty if nothing was filtered.
  RemainingError remaining_error() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Filters a frame without other frames, tile by tile, which takes little memory besides the image. The result differs
/// from FrameFilter's only by rounding.
Image filter_alone(Image image);

}  // namespace tempolux
