// lib/image/why_mask.h -- masks: which pixels of a frame must be traced, and for which causes (formats/mask/mask.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/mask/why.h"
#include "lib/image/image.h"
#include "lib/image/preview.h"

namespace tempolux {

/// Name of the one channel of a mask.
inline constexpr const char* kWhyChannel = "why";

/// True if the image has the channel `why` as uint.
bool is_why_mask(const Image& image);

/// The causes by pixel, sums of formats::Why. Throws InputError, beginning with `name`, if the channel is missing or
/// of another type.
const std::vector<std::uint32_t>& whys_in(const Image& image, const std::string& name);

/// Number of pixels masked for a cause.
struct WhyCount {
  std::string name;
  std::uint64_t pixels = 0;  ///< that have it
  std::uint64_t first = 0;   ///< pixels for which it is the first cause in the order of formats::kWhys
};

/// One entry for each of formats::kWhys, then "unknown" if any pixel has unnamed bits. The sum of `first` is the number
/// of masked pixels.
std::vector<WhyCount> count_whys(const std::vector<std::uint32_t>& whys);

/// Colours each pixel by its first cause; black where `why` is 0, brown for unnamed bits.
Picture why_picture(const Image& image, const std::vector<std::uint32_t>& whys);

}  // namespace tempolux
