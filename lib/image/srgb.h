// lib/image/srgb.h -- the sRGB transfer.
#pragma once

#include <vector>

namespace tempolux {

/// sRGB transfer (IEC 61966-2-1), encoded [0, 1] to linear [0, 1] and back. The inverse maps values below 0 to 0 and
/// above 1 to 1.
float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

/// sRGB code of a linear value, 0 to 255, not rounded; the value is clipped at 0 and 1.
double srgb_code(double value);

/// Factor that brings the median of `means`, the mean channels of a picture's pixels, to .18. If more than half of them
/// are 0, the median of the others is used. 1 for a black picture.
double exposure_of(std::vector<double> means);

/// Mean of `means`, of which each counts at most as much as white at their exposure_of(): a lamp in view is one white
/// spot, however bright it is. 0 without elements.
double mean_to_white(const std::vector<double>& means);

}  // namespace tempolux
