#include "lib/warp/key_frame.h"

#include <algorithm>
#include <map>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/core/parallel_each.h"
#include "lib/image/channel_groups.h"

namespace tempolux {
namespace {

/// True for colours of light, which are warped.
bool is_light(const std::string& channel) {
  if (!is_colour(channel)) return false;
  const std::string layer = channel.substr(0, std::max<std::size_t>(channel.size(), 2) - 2);
  return layer != "albedo" && layer != "variance" && !layer.starts_with("variance.") && !layer.starts_with("coverage.");
}

}  // namespace

KeyFrame::KeyFrame(const Image& image, const std::string& name, const FrameCamera& camera)
    : name_(name),
      camera_(camera),
      seen_(seen_in(image, name)),
      whole_(whole_pixels(seen_, camera_)),
      shown_(seen_.pixel_count()) {
  parallel_each(shown_.size(), 4096, [&](std::size_t p) {
    shown_[p] = {seen_.depth[p], seen_.object_at(p), seen_.normal_at(p)};
  });
  std::map<std::string, const Channel*> channels;
  for (const Channel& channel : image.channels)
    if (is_light(channel.name) && channel.ids.empty()) channels.emplace(channel.name, &channel);
  for (const char* needed : {"R", "G", "B"})
    if (!channels.contains(needed))
      throw InputError(name + ": has no channel " + needed + "; a key is a picture: render it with RGBA");
  if (channels.size() > kMostChannels)
    throw InputError(name + ": has " + std::to_string(channels.size()) + " channels of colour, at most " +
                     std::to_string(kMostChannels) + " are warped; leave passes out");
  for (const auto& [channel_name, channel] : channels) names_.push_back(channel_name);
  stride_ = (names_.size() + 7) / 8 * 8;
  colour_ = std::make_unique_for_overwrite<float[]>(image.pixel_count() * stride_);
  constexpr std::size_t kTogether = 256;  // pixels whose colours fit into the first-level cache
  parallel_chunks(image.pixel_count(), 16 * kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t first = begin; first < end; first += kTogether) {
      const std::size_t last = std::min(first + kTogether, end);
      std::size_t c = 0;
      for (const auto& [channel_name, channel] : channels) {
        const float* values = channel->values.data();
        float* colour = colour_.get() + c++;
        for (std::size_t p = first; p < last; ++p) colour[p * stride_] = values[p];
      }
      for (; c < stride_; ++c)
        for (std::size_t p = first; p < last; ++p) colour_[p * stride_ + c] = 0;
    }
  });
}

}  // namespace tempolux
