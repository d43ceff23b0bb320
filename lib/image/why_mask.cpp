#include "lib/image/why_mask.h"

#include <algorithm>

#include "formats/error.h"

namespace tempolux {
namespace {

constexpr std::size_t kKnown = formats::kWhys.size();
constexpr std::array<std::uint8_t, 3> kUnknownColor{120, 80, 40};

/// Index into kWhys of a pixel's first cause; kKnown if it only has unnamed bits.
std::size_t first_cause(std::uint32_t why) {
  std::size_t i = 0;
  while (i < kKnown && !(why & formats::kWhys[i].bit)) ++i;
  return i;
}

}  // namespace

bool is_why_mask(const Image& image) {
  const Channel* channel = image.find(kWhyChannel);
  return channel && !channel->ids.empty();
}

const std::vector<std::uint32_t>& whys_in(const Image& image, const std::string& name) {
  const Channel* channel = image.find(kWhyChannel);
  if (!channel) throw InputError(name + ": has no channel 'why'; a mask has one (formats/mask/mask.md)");
  if (channel->ids.empty())
    throw InputError(name + ": channel why: samples are no integers; a mask's are uint (formats/mask/mask.md)");
  return channel->ids;
}

std::vector<WhyCount> count_whys(const std::vector<std::uint32_t>& whys) {
  std::vector<WhyCount> counts;
  std::uint32_t known = 0;
  for (const auto& [bit, name, color] : formats::kWhys) {
    counts.push_back({std::string(name)});
    known |= bit;
  }
  WhyCount unknown{"unknown"};
  for (const std::uint32_t why : whys) {
    if (why == 0) continue;
    for (std::size_t i = 0; i < kKnown; ++i) counts[i].pixels += (why & formats::kWhys[i].bit) != 0;
    unknown.pixels += (why & ~known) != 0;
    const std::size_t first = first_cause(why);
    ++(first < kKnown ? counts[first] : unknown).first;
  }
  if (unknown.pixels > 0) counts.push_back(unknown);
  return counts;
}

Picture why_picture(const Image& image, const std::vector<std::uint32_t>& whys) {
  Picture picture{image.width, image.height, std::vector<std::uint8_t>(3 * whys.size())};
  for (std::size_t p = 0; p < whys.size(); ++p) {
    if (whys[p] == 0) continue;
    const std::size_t first = first_cause(whys[p]);
    const auto& color = first < kKnown ? formats::kWhys[first].color : kUnknownColor;
    std::copy(color.begin(), color.end(), picture.rgb.begin() + std::ptrdiff_t(3 * p));
  }
  return picture;
}

}  // namespace tempolux
