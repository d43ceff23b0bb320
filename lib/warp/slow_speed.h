// lib/warp/slow_speed.h -- below which speed an eye sees the errors that warping makes.
#pragma once

namespace tempolux {

/// Highest spatial frequency, cycles per degree, that an eye sees at all (contrast sensitivity 1) of what moves over
/// its retina at this speed, degrees/s >= 0.15: Kelly's formula with Daly's constants (docs/methods/formulas.md).
double highest_visible_frequency(double retinal_speed);

/// Speed of a pattern, degrees/s, from which on an eye that does not follow it sees no more than the share 0.9 of the
/// frequencies that a display of so many pixels per degree shows (docs/methods/formulas.md): what is blurred by less
/// than a pixel looks the same then. 30 pixels per degree: 1.41. 0.15, the drift of a resting eye, below which the eye
/// itself moves.
double slow_speed(double pixels_per_degree);

}  // namespace tempolux
