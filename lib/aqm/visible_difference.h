// lib/aqm/visible_difference.h -- where a viewer would see that two pictures differ: the animation quality
// metric.
//
// Daly's visible differences predictor with the sensitivity of each pixel's own motion, as the walkthroughs
// of Myszkowski, Rokita and Tawara use it. What is published and what is ours: docs/methods/vision.md.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/aqm/vision_model.h"

namespace tempolux::vision {

/// Two pictures of width x height pixels as a display shows them, cd/m2, row 0 on top. Pixels where `counted`
/// is 0 are taken for equal in both, whatever they hold; empty: all count.
struct DisplayedPair {
  int width = 0, height = 0;
  std::vector<float> first, second;
  std::vector<std::uint8_t> counted;
};

/// Who looks at them, and from where.
struct Viewing {
  double pixels_per_degree = 0;
  Gaze gaze = Gaze::track;
  double distance = 0.6;  ///< of the display, metres
};

/// What detection_map() finds.
struct Detection {
  std::vector<float> probability;   ///< of seeing a difference, per pixel; 0 where pixels do not count
  double adaptation_luminance = 0;  ///< cd/m2; its response is the mean response to what counts in both pictures
};

/// The probability that a viewer sees a difference at each pixel. `speed` is display_speed(), deg/s; empty:
/// nothing is known of motion, and eyes look around in a still picture (static_contrast_sensitivity). Equal pictures
/// give 0 everywhere, and the order of the two does not matter. The same bytes for any number of threads.
Detection detection_map(const DisplayedPair& pair, const std::vector<float>& speed, const Viewing& viewing);

}  // namespace tempolux::vision
