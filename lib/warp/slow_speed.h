// lib/warp/slow_speed.h -- the speed below which an eye sees the errors of warping.
#pragma once

namespace tempolux {

/// Highest spatial frequency, cycles per degree, that an eye sees (contrast sensitivity 1) of a pattern that moves over
/// the retina at this speed (degrees/s, >= 0.15): Kelly's formula with Daly's constants (docs/methods/formulas.md).
double highest_visible_frequency(double retinal_speed);

/// Speed of a pattern, degrees/s, above which an eye that does not follow sees at most the share 0.9 of the frequencies
/// that a display with this many pixels per degree shows (docs/methods/formulas.md), so that blur below a pixel is
/// invisible. For 30 pixels per degree: 1.41. At least 0.15, the drift of a resting eye.
double slow_speed(double pixels_per_degree);

}  // namespace tempolux
