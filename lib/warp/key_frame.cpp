#include "lib/warp/key_frame.h"

#include <algorithm>
#include <map>

#include "formats/error.h"
#include "lib/core/parallel.h"

namespace tempolux {
namespace {

/// The name that our frames give a channel of colour; "": it is none. Blender's Combined is its picture.
std::string our_colour_name(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  const std::string last = dot == std::string::npos ? channel : channel.substr(dot + 1);
  if (last != "R" && last != "G" && last != "B" && last != "A") return "";
  if (dot == std::string::npos) return channel;
  const std::string layer = channel.substr(0, dot);
  if (layer == "Combined" || layer.ends_with(".Combined")) return last;
  if (layer == "albedo" || layer == "variance" || layer.starts_with("variance.")) return "";
  return channel;
}

}  // namespace

KeyFrame::KeyFrame(const Image& image, const std::string& name, const FrameCamera& camera)
    : name_(name), camera_(camera), seen_(seen_in(image, name)) {
  whole_ = whole_pixels(seen_, camera_);
  std::map<std::string, const Channel*> channels;
  for (const Channel& channel : image.channels)
    if (const std::string ours = our_colour_name(channel.name); !ours.empty() && channel.ids.empty())
      channels.emplace(ours, &channel);
  for (const char* needed : {"R", "G", "B"})
    if (!channels.contains(needed))
      throw InputError(name + ": has no channel " + needed + "; a key is a picture: render it with RGBA");
  for (const auto& [ours, channel] : channels) names_.push_back(ours);
  stride_ = (names_.size() + 7) / 8 * 8;
  colour_.resize(image.pixel_count() * stride_);
  parallel_chunks(image.pixel_count(), 16384, [&](std::size_t first, std::size_t last) {
    std::size_t c = 0;
    for (const auto& [ours, channel] : channels) {
      for (std::size_t p = first; p < last; ++p) colour_[p * stride_ + c] = channel->values[p];
      ++c;
    }
  });
}

}  // namespace tempolux
