#include "lib/image/pixel_flow.h"

#include <cmath>

#include "formats/error.h"

namespace tempolux {
namespace {

const Channel& channel_of(const Image& image, const char* channel, bool ids, const std::string& name) {
  const Channel* found = image.find(channel);
  if (!found) throw InputError(name + ": has no channel '" + channel + "'; pixel flow has it (formats/flow/flow.md)");
  if (found->ids.empty() == ids)
    throw InputError(name + ": channel " + channel + ": is not of type " + (ids ? "uint" : "float") +
                     "; pixel flow has it so (formats/flow/flow.md)");
  return *found;
}

std::string place(const std::string& name, const char* channel, std::size_t pixel, int width) {
  return name + ": channel " + channel + ": " + pixel_name(pixel, width) + ": ";
}

/// Reads and checks one component of the field's vectors.
void take(const Image& image, const char* channel, float Vec2::*component, std::vector<Vec2>& field,
          const std::string& name) {
  const std::vector<float>& values = channel_of(image, channel, false, name).values;
  for (std::size_t p = 0; p < values.size(); ++p) {
    if (!std::isfinite(values[p]))
      throw InputError(place(name, channel, p, image.width) + "not finite; flow that is not known is 0, with valid 0");
    field[p].*component = values[p];
  }
}

}  // namespace

PixelFlow::PixelFlow(int width_, int height_) : width(width_), height(height_) {
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  forward.resize(pixels);
  backward.resize(pixels);
  valid.resize(pixels);
  speed.resize(pixels);
}

void add_flow_channels(const PixelFlow& flow, Image& image) {
  const auto add = [&](const char* channel, const auto& field, auto component) {
    std::vector<float>& values = image.add(channel).values;
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = field[p].*component;
  };
  add("forward.u", flow.forward, &Vec2::x);
  add("forward.v", flow.forward, &Vec2::y);
  add("backward.u", flow.backward, &Vec2::x);
  add("backward.v", flow.backward, &Vec2::y);
  image.add("speed").values = flow.speed;
  image.add_ids("valid").ids = flow.valid;
}

PixelFlow flow_in(const Image& image, const std::string& name) {
  PixelFlow flow(image.width, image.height);
  take(image, "forward.u", &Vec2::x, flow.forward, name);
  take(image, "forward.v", &Vec2::y, flow.forward, name);
  take(image, "backward.u", &Vec2::x, flow.backward, name);
  take(image, "backward.v", &Vec2::y, flow.backward, name);
  flow.speed = channel_of(image, "speed", false, name).values;
  flow.valid = channel_of(image, "valid", true, name).ids;
  for (std::size_t p = 0; p < flow.valid.size(); ++p) {
    if (flow.valid[p] > (forward_known | backward_known))
      throw InputError(place(name, "valid", p, image.width) + std::to_string(flow.valid[p]) + " is none of 0, 1, 2, 3");
    if (!(flow.speed[p] >= 0 && std::isfinite(flow.speed[p])))
      throw InputError(place(name, "speed", p, image.width) + "is not a number from 0 up");
  }
  return flow;
}

}  // namespace tempolux
