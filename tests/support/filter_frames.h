// tests/support/filter_frames.h -- makes frames for tests of the filter: surfaces, light, noise and flow.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "lib/filter/filter_frame.h"

namespace tempolux::test {

using OfPixel = std::function<float(int, int)>;

inline std::vector<float>& plane(Image& image, const std::string& name, const OfPixel& value) {
  std::vector<float>& values = image.add(name).values;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) values[std::size_t(y * image.width + x)] = value(x, y);
  return values;
}
inline void grey(Image& image, const std::string& layer, const OfPixel& value) {
  for (const char* c : {"R", "G", "B"}) plane(image, layer.empty() ? c : layer + "." + c, value);
}
inline OfPixel everywhere(float value) {
  return [value](int, int) { return value; };
}

/// A wall seen from the front, one object.
inline Image wall(int width, int height) {
  Image image{width, height, {}, {}, {}, {}};
  plane(image, "Z", everywhere(2));
  plane(image, "N.X", everywhere(0));
  plane(image, "N.Y", everywhere(0));
  plane(image, "N.Z", everywhere(1));
  image.add_ids("id.object");
  return image;
}
/// Adds the variance of each pixel's mean, and 16 as the number of samples.
inline void set_variance(Image& image, float variance) {
  grey(image, "variance", everywhere(variance));
  plane(image, "samples", everywhere(16));
}
/// Adds a uniform flow in pixels per frame: +u right, +v up.
inline void moves(Image& image, float u, float v) {
  plane(image, "forward.u", everywhere(u));
  plane(image, "forward.v", everywhere(v));
  plane(image, "backward.u", everywhere(-u));
  plane(image, "backward.v", everywhere(-v));
}

/// Adds the noise channels of a layer: half the difference of its halves.
inline void set_noise(Image& image, const std::string& layer, const OfPixel& noise) {
  grey(image, layer + ".noise", noise);
}

/// Filters the middle frame, with the flow in the frames' own channels.
inline Image filtered(const std::vector<Image>& frames) {
  std::vector<WindowLight> light;
  std::vector<FlowFrame> flow(frames.size());
  for (const Image& frame : frames) light.emplace_back(frame, frames.size() == 1);
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i].find("forward.u")) flow[i] = FlowFrame(frames[i], frames[i].width, frames[i].height, "flow");
  const std::size_t middle = (frames.size() - 1) / 2;
  FrameFilter filter(light[middle], flow[middle], middle, frames.size() - 1 - middle);
  for (std::size_t i = middle; i > 0; --i) filter.add(light[i - 1], flow[i - 1]);
  for (std::size_t i = middle + 1; i < frames.size(); ++i) filter.add(light[i], flow[i]);
  return filter.finish(frames[middle]);
}

inline float at(const Image& image, const std::string& channel, int x, int y) {
  return image.find(channel)->values[std::size_t(y * image.width + x)];
}

/// Gaussian noise: each call gives another number.
class Noise {
 public:
  explicit Noise(float deviation) : normal_(0, deviation) {}
  float operator()() { return normal_(random_); }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<float> normal_;
};

}  // namespace tempolux::test
