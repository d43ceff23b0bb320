#include "lib/image/foreign_names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace tempolux {
namespace {

/// A pass of another program: the ends of its channels' names, before and after the last dot.
struct Pass {
  std::string_view layer, component, ours;
};
constexpr std::array<Pass, 22> kPasses{{{"Combined", "R", "R"},
                                        {"Combined", "G", "G"},
                                        {"Combined", "B", "B"},
                                        {"Combined", "A", "A"},
                                        {"Depth", "Z", "Z"},
                                        {"depth", "Z", "Z"},
                                        {"depth", "z", "Z"},
                                        {"Z", "Z", "Z"},
                                        {"Normal", "X", "N.X"},
                                        {"Normal", "Y", "N.Y"},
                                        {"Normal", "Z", "N.Z"},
                                        {"Vector", "X", "backward.u"},
                                        {"Vector", "Y", "backward.v"},
                                        {"Vector", "Z", "forward.u"},
                                        {"Vector", "W", "forward.v"},
                                        {"Denoising Depth", "Z", "Z"},
                                        {"Denoising Normal", "X", "N.X"},
                                        {"Denoising Normal", "Y", "N.Y"},
                                        {"Denoising Normal", "Z", "N.Z"},
                                        {"Denoising Albedo", "R", "albedo.R"},
                                        {"Denoising Albedo", "G", "albedo.G"},
                                        {"Denoising Albedo", "B", "albedo.B"}}};

/// The parts of a name: "VIEW", "Combined" and "R" of "VIEW.Combined.R".
struct Parts {
  std::string_view view, layer, component;
};
Parts parts_of(std::string_view channel) {
  const std::size_t last = channel.rfind('.');
  if (last == std::string_view::npos || last == 0) return {};
  const std::size_t dot = channel.rfind('.', last - 1);
  if (dot == std::string_view::npos) return {"", channel.substr(0, last), channel.substr(last + 1)};
  return {channel.substr(0, dot), channel.substr(dot + 1, last - dot - 1), channel.substr(last + 1)};
}

const Pass* pass_of(const Parts& parts) {
  for (const Pass& pass : kPasses)
    if (parts.layer == pass.layer && parts.component == pass.component) return &pass;
  return nullptr;
}

/// The view layer whose passes are used; "" if none has a picture.
std::string view_of(const Image& image) {
  std::string first;
  bool any = false;
  for (const Channel& channel : image.channels)
    if (const Parts parts = parts_of(channel.name); parts.layer == "Combined" && (!any || parts.view < first)) {
      first = parts.view;
      any = true;
    }
  return first;
}

}  // namespace

std::string our_name(const std::string& channel) {
  const Pass* pass = pass_of(parts_of(channel));
  return pass ? std::string(pass->ours) : channel;
}

void name_as_ours(Image& image) {
  const std::string view = view_of(image);
  // Plain passes come first: denoising passes look through mirrors and average over edges.
  for (const bool for_denoisers : {false, true})
    for (Channel& channel : image.channels) {
      const Parts parts = parts_of(channel.name);
      const Pass* pass = pass_of(parts);
      if (!pass || parts.layer.starts_with("Denoising") != for_denoisers || image.find(pass->ours) ||
          (!view.empty() && parts.view != view))
        continue;
      const bool turned = parts.layer == "Vector" && pass->ours.starts_with("forward");
      channel.name = pass->ours;  // last, since `parts` refers to the old name
      for (float& value : channel.values) {
        if (channel.name == "Z" && value >= kNothingDepth) value = INFINITY;
        if (turned) value = -value;
      }
    }
  std::ranges::sort(image.channels, {}, &Channel::name);
}

}  // namespace tempolux
