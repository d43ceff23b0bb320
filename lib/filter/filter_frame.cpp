#include "lib/filter/filter_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "formats/error.h"
#include "lib/filter/collect.h"
#include "lib/filter/fit.h"
#include "lib/filter/resolve.h"
#include "lib/filter/rows.h"
#include "lib/filter/unmix.h"
#include "lib/filter/visible_blur.h"

namespace tempolux {
namespace {

constexpr std::array<const char*, 5> kLayersInOrder{"emission", "specular", "direct", "caustic", "indirect"};
constexpr int kFirstRadius = 2;   ///< pixels: of the fit that values are compared by
constexpr std::array<const char*, 3> kComponents{"R", "G", "B"};

std::string channel_name(const std::string& layer, std::size_t c) {
  return layer.empty() ? kComponents[c] : layer + "." + kComponents[c];
}

Channel* float_channel(Image& image, const std::string& name) {
  Channel* channel = image.find(name);
  return channel && !channel->values.empty() ? channel : nullptr;
}

/// Pixels at edges keep their values, if they are numbers: what they see of which surface is not known.
void write_inside(const LightFrame& frame, const EdgePlane& light, std::vector<float>& values) {
  for_each_row(frame.height, [&](int y) {
    float* to = values.data() + std::size_t(y) * std::size_t(frame.width);
    for (int x = 0; x < frame.width; ++x)
      if ((frame.inside.at(x, y) != 0 || frame.use.at(x, y) != 0 || !std::isfinite(to[x])) && !is_too_bright(to[x])) to[x] = light.own_at(x, y);
  });
}

void check_window(std::span<const WindowFrame> window, std::size_t middle) {
  const LightFrame& frame = *window[middle].light;
  for (const WindowFrame& other : window) {
    if (other.light->width != frame.width || other.light->height != frame.height)
      throw InputError("frames of " + std::to_string(frame.width) + "x" + std::to_string(frame.height) + " and of " +
                       std::to_string(other.light->width) + "x" + std::to_string(other.light->height) +
                       " pixels; all frames of a window have one size");
    if (other.light->layers != frame.layers || other.light->albedo[0].empty() != frame.albedo[0].empty())
      throw InputError("frames of a window have different layers; write all with the same --channels");
  }
}

/// What stands for knowledge of noise where there is none.
struct PlainWeights {
  std::vector<float> frames;   ///< by frame of the window; empty: 1 each
  Plane in_time;               ///< 1: the pixel takes light from other frames
  Plane reach2;                ///< FitOptions
};

PlainWeights plain_weights(const Image& image, std::span<const WindowFrame> window, std::size_t middle, const FilterOptions& options) {
  constexpr float kEnd = 1.5f, kDeviations2 = 8;   // (1 - r^2 / (8 s^2))^2 has the standard deviation s along each axis
  PlainWeights plain;
  const float widest = float(std::max(middle, window.size() - 1 - middle));
  for (std::size_t i = 0; i < window.size(); ++i) {
    const float deviations = i == middle ? 0 : kEnd * (float(i) - float(middle)) / widest;
    plain.frames.push_back(std::exp(-0.5f * deviations * deviations));
  }
  const VisibleBlur blur(options.pixels_per_degree);
  const auto found = image.numbers.find("framesPerSecond");
  const float fps = found != image.numbers.end() && found->second > 0 ? float(found->second) : 24.0f;
  plain.in_time = plain.reach2 = Plane(image.width, image.height);
  for_each_row(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      FlowFrame::Step step = window[middle].flow->step(std::size_t(y) * std::size_t(image.width) + std::size_t(x), 1);
      if (!step.known) step = window[middle].flow->step(std::size_t(y) * std::size_t(image.width) + std::size_t(x), -1);
      const float speed = step.known ? fps * std::hypot(step.right, step.down) : 0, sigma = blur.sigma(speed);
      plain.in_time.at(x, y) = blur.hides(speed) ? 1.0f : 0.0f;
      plain.reach2.at(x, y) = kDeviations2 * sigma * sigma;
    }
  });
  return plain;
}

/// Puts what a first fit of the sum of the layers finds in the place of the means that values are compared by: a plane follows light that
/// changes where a mean lags behind. Its variance is that of as many samples, times 3: at the border of a window a plane knows its value by
/// 4 times less than a mean does, in the middle by as much.
void compare_by_fit(const LightFrame& frame, int radius, Collected& collected) {
  constexpr float kPlane = 3;
  // A view of the same pixels whose only layer is the sum; the planes are lent and taken back.
  Collected sum;
  sum.light.resize(1);
  for (Plane& plane : sum.light[0]) plane = Plane(frame.width, frame.height);
  for_each_row(frame.height, [&](int y) {
    for (std::size_t c = 0; c < 3; ++c)
      for (const ColourPlane& layer : collected.light)
        if (!layer[c].empty())
          for (int x = 0; x < frame.width; ++x) sum.light[0][c].at(x, y) += layer[c].at(x, y);
  });
  sum.weight = std::move(collected.weight);
  sum.mean = std::move(collected.mean);
  sum.mean_variance = std::move(collected.mean_variance);
  Fitted first = fit(frame, sum, {.radius = std::min(kFirstRadius, radius)});
  collected.weight = std::move(sum.weight);
  collected.mean = std::move(first.light[0]);
  collected.mean_variance = std::move(sum.mean_variance);
  for_each_row(frame.height, [&](int y) {
    for (int x = 0; x < frame.width; ++x)
      collected.mean_variance.at(x, y) = kPlane * frame.variance.at(x, y) / std::max(first.support.at(x, y), 1.0f);
  });
}

/// What is not finite in what passes the filter becomes 0; of depth infinity is allowed, and what is not a number becomes it.
void leave_numbers(Image& image) {
  for (Channel& channel : image.channels) {
    const bool depth = channel.name == "Z";
    for (float& value : channel.values)
      if (!std::isfinite(value)) value = depth ? INFINITY : 0.0f;
  }
}

void sum_layers(Image& image) {
  for (std::size_t c = 0; c < 3; ++c) {
    Channel* whole = float_channel(image, kComponents[c]);
    if (!whole) return;
    std::array<const Channel*, 5> parts{};
    for (std::size_t l = 0; l < parts.size(); ++l)
      if (!(parts[l] = float_channel(image, channel_name(kLayersInOrder[l], c)))) return;
    for (std::size_t p = 0; p < whole->values.size(); ++p) {
      float sum = parts[0]->values[p];
      for (std::size_t l = 1; l < parts.size(); ++l) sum += parts[l]->values[p];
      whole->values[p] = sum;
    }
  }
}

}  // namespace

Image filter_frame(Image image, std::span<const WindowFrame> window, std::size_t middle, const FilterOptions& options) {
  if (options.radius < 0 || options.radius > kMargin) throw std::invalid_argument("filter_frame: radius");
  check_window(window, middle);
  const LightFrame& frame = *window[middle].light;
  FitOptions fit_options;
  fit_options.radius = options.radius;
  fit_options.by_value = frame.noise != NoiseKnowledge::none;
  PlainWeights plain;
  if (!fit_options.by_value) {
    plain = plain_weights(image, window, middle, options);
    fit_options.reach2 = &plain.reach2;
  }
  Collected collected = collect(window, middle, plain.frames, plain.in_time.empty() ? nullptr : &plain.in_time);
  if (fit_options.by_value) compare_by_fit(frame, options.radius, collected);
  Fitted fitted = fit(frame, collected, fit_options);
  const Coverage coverage(image);
  unmix(frame, collected, coverage, options.radius, int(window.size()), fitted);

  for (std::size_t l = 0; l < frame.layers.size(); ++l)
    for (std::size_t c = 0; c < 3; ++c) {
      if (fitted.light[l][c].empty()) continue;   // black before and after
      const EdgePlane light{fitted.light[l][c], fitted.other[l][c], frame.albedo[c]};
      std::vector<float>& values = float_channel(image, channel_name(frame.layers[l], c))->values;
      if (coverage.known()) resolve(light, coverage, frame.width, frame.height, values);
      else write_inside(frame, light, values);
    }
  if (coverage.known()) resolve_passing(frame, coverage, image);
  sum_layers(image);
  leave_numbers(image);
  return image;
}

}  // namespace tempolux
