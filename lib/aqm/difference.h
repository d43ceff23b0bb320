// lib/aqm/difference.h -- where a frame differs from its reference, to measure and to look at.
#pragma once

#include "lib/aqm/compared.h"
#include "lib/image/preview.h"

namespace tempolux {

/// x - r per channel, signed, 0 where pixels do not count; r is the mean of the halves. Channels R, G, B for
/// a colour layer, Y for a single channel, else the layer's suffixes.
Image difference_image(const Compared& pair);

/// The scale of a difference picture: the smallest of 1, 2, 5 x 10^k that is not below the 99th percentile of
/// |d|, d = mean over channels of x - r. 1 if all differences are 0.
double difference_scale(const Compared& pair);

/// d as a picture: grey where 0, towards red where x is above r, towards blue where below, full at
/// |d| = scale.
Picture difference_picture(const Compared& pair, double scale);

}  // namespace tempolux
