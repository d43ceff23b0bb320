// lib/filter/filter_frame.h -- a frame filtered in space and time: fewer samples for the same picture.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lib/filter/flow_path.h"

namespace tempolux {

struct FilterOptions {
  int radius = 6;                     ///< pixels of the window in space, at most kMargin
  double pixels_per_degree = 30;      ///< of the viewer's screen; where nothing is known of noise (visible_blur.h)
};

/// Filters the frame `image`: light in kFilteredLayers (or R G B where none of them is there) is collected along the flow
/// (collect.h) and fitted in space (fit.h), put together at edges where `image` has coverage (resolve.h), multiplied by albedo again. Emission
/// and specular pass by but at edges; R G B is the sum of the layers in their order where all five are there. Pixels at edges keep their own
/// values where coverage is not known. Other channels and all attributes are the frame's.
/// Where nothing is known of noise (LightFrame::noise) frames count by a Gaussian over the window, which ends at 1.5 of its standard
/// deviation, and pixels by one that cannot be seen, both by the speed of the pixel (VisibleBlur); slow ones take nothing from other frames.
class FrameFilter {
 public:
  /// middle: made of `image`; its light outlives this. before, after: frames of the window. std::invalid_argument for options out of range.
  FrameFilter(const Image& image, const WindowFrame& middle, std::size_t before, std::size_t after, const FilterOptions& options);
  ~FrameFilter();
  FrameFilter(const FrameFilter&) = delete;
  FrameFilter& operator=(const FrameFilter&) = delete;

  /// The frames of the window in the order in which they are followed: the `before` ones, the nearest first, then the `after` ones. None is
  /// looked at after the call. InputError if it differs from the middle's in size or layers.
  void add(const WindowFrame& frame);
  /// Once, after all were added.
  Image finish(Image image);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// InputError if two frames of a window differ in size or layers.
void check_frame(const LightFrame& frame, const LightFrame& other);

/// The same of window[middle], all of whose frames are at hand.
Image filter_frame(Image image, std::span<const WindowFrame> window, std::size_t middle, const FilterOptions& options);

}  // namespace tempolux
