#include "lib/compose/smoke_layer.h"

#include <algorithm>
#include <array>

#include "lib/image/channel_groups.h"

namespace tempolux {
namespace {

constexpr std::array kVolume{"volume.R", "volume.G", "volume.B"}, kColour{"R", "G", "B"};

/// True for R, G, B of the frame and of its layers, but not for albedo, its error and mattes.
bool is_light(const Channel& channel) {
  const std::string& name = channel.name;
  const bool rgb = name.ends_with('R') || name.ends_with('G') || name.ends_with('B');
  return rgb && !channel.values.empty() && (name.size() == 1 || name[name.size() - 2] == '.') &&
         !name.starts_with("albedo") && !name.starts_with("coverage") && !is_matte(name);
}

}  // namespace

bool has_smoke(const Image& frame) {
  return std::ranges::any_of(kVolume, [&](const char* name) {
    const Channel* channel = frame.find(name);
    return channel && std::ranges::any_of(channel->values, [](float value) { return value != 0; });
  });
}

void add_smoke(const std::vector<SmokePixel>& smoke, bool attenuated, Image& frame) {
  for (const char* name : kVolume)
    if (!frame.find(name)) frame.add(name);
  if (!attenuated)
    for (Channel& channel : frame.channels)
      for (std::size_t p = 0; is_light(channel) && p < smoke.size(); ++p) channel.values[p] *= smoke[p].transmittance;
  for (std::size_t c = 0; c < 3; ++c) {
    Channel &volume = *frame.find(kVolume[c]), &colour = *frame.find(kColour[c]);
    for (std::size_t p = 0; p < smoke.size(); ++p) {
      volume.values[p] = smoke[p].light[int(c)];
      colour.values[p] += smoke[p].light[int(c)];
    }
  }
  if (Channel* alpha = frame.find("A"); alpha && !attenuated)
    for (std::size_t p = 0; p < smoke.size(); ++p)
      alpha->values[p] = 1 - smoke[p].transmittance * (1 - alpha->values[p]);
}

}  // namespace tempolux
