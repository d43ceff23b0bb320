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

/// The causes of each pixel, a sum of formats::Why. Throws InputError "NAME: ..." if the channel is missing or of
/// another type.
const std::vector<std::uint32_t>& whys_in(const Image& image, const std::string& name);

/// Numbers of pixels for a cause.
struct WhyCount {
  std::string name;          ///< of the cause
  std::uint64_t pixels = 0;  ///< with this cause
  std::uint64_t first = 0;   ///< with this cause and no earlier one in the order of formats::kWhys
};

/// Counts for each of formats::kWhys, then "unknown" if a pixel has unnamed bits. The sum of `first` is the number of
/// masked pixels.
std::vector<WhyCount> count_whys(const std::vector<std::uint32_t>& whys);

/// Colours each pixel by its first cause; black where `why` is 0, brown for unnamed bits.
Picture why_picture(const Image& image, const std::vector<std::uint32_t>& whys);

}  // namespace tempolux
