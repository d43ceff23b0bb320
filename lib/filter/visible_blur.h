// lib/filter/visible_blur.h -- how much blur a viewer does not see, by how fast what is blurred moves on the retina.
#pragma once

#include <vector>

namespace tempolux {

/// What the filter takes where nothing is known of noise: as much as cannot be seen (docs/methods/st-filter.md).
class VisibleBlur {
 public:
  /// pixels_per_degree: of visual angle, > 0.
  explicit VisibleBlur(double pixels_per_degree);

  /// Speed on the retina [deg/s] of a pattern that moves by `speed` [deg/s] and that the eye follows as well as it can: Daly 1998.
  static double retinal(double speed);
  /// Contrast sensitivity at `frequency` [cycles/deg] and retinal speed `v` [deg/s]: Kelly 1979 as refitted by Daly 1998.
  static double sensitivity(double frequency, double v);
  /// Highest frequency [cycles/deg] of which contrast 1 is just seen at retinal speed v.
  static double cutoff(double v);

  /// Standard deviation [pixels] of the Gaussian that halves the amplitude at the cut-off, for a pattern moving by `pixels` per
  /// second.
  float sigma(float pixels) const;
  /// Does so fast a pattern hide half of the frequencies that the picture can hold (0.9 of them)? Slower ones stay sharp in time.
  bool hides(float pixels) const { return double(pixels) / pixels_per_degree_ >= slow_; }

 private:
  double pixels_per_degree_, slow_;
  std::vector<float> sigma_;   ///< by speed, kPerOctave to an octave
};

}  // namespace tempolux
