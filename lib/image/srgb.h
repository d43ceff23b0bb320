// lib/image/srgb.h -- the sRGB transfer.
#pragma once

#include <vector>

namespace tempolux {

/// sRGB transfer (IEC 61966-2-1), encoded [0, 1] to linear [0, 1] and back. The inverse maps values below 0 to 0 and
/// above 1 to 1.
float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

/// sRGB code of a linear value, from 0 to 255, not rounded; the value is clipped to [0, 1].
double srgb_code(double value);

/// Factor that brings the median of `means` to .18. `means` has the mean of R, G and B for each pixel of a picture. If
/// their median is 0, zeros are dropped first. 1 for a black picture.
double exposure_of(std::vector<double> means);

/// Mean of `means`, each clipped to the value that exposure_of() brings to 1: a lamp in view is a white spot, however
/// bright it is. 0 without elements.
double mean_to_white(const std::vector<double>& means);

}  // namespace tempolux
