// lib/image/why_mask.h -- masks: which pixels of a frame must be traced, and why (formats/mask/mask.md).
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

/// The causes by pixel, sums of formats::Why. Throws InputError, beginning with `name`, if the channel is absent or of
/// another type.
const std::vector<std::uint32_t>& whys_in(const Image& image, const std::string& name);

/// How many pixels a cause has.
struct WhyCount {
  std::string name;
  std::uint64_t pixels = 0;  ///< that have it
  std::uint64_t first = 0;   ///< that have it and none that stands before it in formats::kWhys
};

/// One entry for each of formats::kWhys, then "unknown" for bits without a name if there are any. The sum of `first` is
/// the number of pixels that are not 0.
std::vector<WhyCount> count_whys(const std::vector<std::uint32_t>& whys);

/// Each pixel in the colour of its first cause; black where `why` is 0; brown for bits without a name.
Picture why_picture(const Image& image, const std::vector<std::uint32_t>& whys);

}  // namespace tempolux
