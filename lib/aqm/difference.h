// lib/aqm/difference.h -- pictures of the difference between a frame and its reference.
#pragma once

#include "lib/aqm/compared.h"
#include "lib/image/preview.h"

namespace tempolux {

/// The signed difference x - r per channel; x is the frame, r the reference or the mean of its halves. 0 where pixels
/// do not count. The result has the channels R, G, B if a layer of colours is compared, and Y if a layer of one channel
/// is. The result of any other layer has the suffixes of that layer's channels: N.X, N.Y, N.Z give X, Y, Z.
Image difference_image(const Compared& pair);

/// The scale of a difference picture: the smallest of 1, 2, 5 x 10^k that is at least the 99th percentile of |d|, where
/// d is the mean of x - r over the channels. 1 if all differences are 0.
double difference_scale(const Compared& pair);

/// d as a picture: grey at 0, towards red where x is above r, towards blue where x is below r, saturated at |d| =
/// scale.
Picture difference_picture(const Compared& pair, double scale);

}  // namespace tempolux
