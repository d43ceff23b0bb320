// lib/aqm/visible_difference.h -- the animation quality metric: the probability that a viewer sees a difference between
// two pictures.
//
// Daly's visible differences predictor with the sensitivity at each pixel's speed, as used for the walkthroughs of
// Myszkowski, Rokita and Tawara. docs/methods/vision.md distinguishes published formulas from our own.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/aqm/vision_model.h"

namespace tempolux::vision {

/// Two pictures of width x height pixels as a display shows them, cd/m2, row 0 on top. Pixels where `counted` is 0
/// count as equal in both; empty: all count.
struct DisplayedPair {
  int width = 0, height = 0;
  std::vector<float> first, second;
  std::vector<std::uint8_t> counted;
};

/// The viewer's situation.
struct Viewing {
  double pixels_per_degree = 0;
  Gaze gaze = Gaze::track;
  double distance = 0.6;  ///< from the display, metres
};

/// Result of detection_map().
struct Detection {
  std::vector<float> probability;  ///< of seeing a difference, by pixel; 0 where pixels do not count
  /// cd/m2; the luminance of the mean response to all counting pixels of both pictures.
  double adaptation_luminance = 0;
};

/// The probability that a viewer sees a difference at each pixel. `speed` is display_speed(), deg/s; empty: motion is
/// unknown, and eyes look around in a still picture (static_contrast_sensitivity). Equal pictures give 0 everywhere;
/// the order of the two does not matter. The same bytes for any number of threads.
Detection detection_map(const DisplayedPair& pair, const std::vector<float>& speed, const Viewing& viewing);

}  // namespace tempolux::vision
