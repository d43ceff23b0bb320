// lib/image/srgb.h -- the sRGB transfer.
#pragma once

namespace tempolux {

/// sRGB transfer (IEC 61966-2-1), encoded [0, 1] to linear [0, 1] and back. The inverse maps values below 0 to 0 and
/// above 1 to 1.
float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

}  // namespace tempolux
