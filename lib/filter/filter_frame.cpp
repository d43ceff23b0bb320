#include "lib/filter/filter_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "formats/error.h"
#include "lib/filter/collect.h"
#include "lib/filter/fit.h"
#include "lib/filter/picture.h"
#include "lib/filter/resolve.h"
#include "lib/filter/rows.h"
#include "lib/filter/unmix.h"
#include "lib/filter/visible_blur.h"

namespace tempolux {
namespace {

constexpr int kFirstRadius = 2;   ///< pixels: of the fit that values are compared by
/// Pixels at edges keep their values, if they are numbers: what they see of which surface is not known.
void write_inside(const LightFrame& frame, const EdgePlane& light, std::vector<float>& values) {
  for_each_row(frame.height, [&](int y) {
    float* to = values.data() + std::size_t(y) * std::size_t(frame.width);
    for (int x = 0; x < frame.width; ++x)
      if ((frame.inside.at(x, y) != 0 || frame.use.at(x, y) != 0 || !std::isfinite(to[x])) && !is_too_bright(to[x])) to[x] = light.own_at(x, y);
  });
}

/// What stands for knowledge of noise where there is none.
struct PlainWeights {
  Plane in_time;               ///< 1: the pixel takes light from other frames
  Plane reach2;                ///< FitOptions
};

PlainWeights plain_weights(const Image& image, const FlowFrame& flow, const FilterOptions& options) {
  constexpr float kDeviations2 = 8;   // (1 - r^2 / (8 s^2))^2 has the standard deviation s along each axis
  PlainWeights plain{Plane::unset(image.width, image.height), Plane::unset(image.width, image.height)};
  const VisibleBlur blur(options.pixels_per_degree);
  const auto found = image.numbers.find("framesPerSecond");
  const float fps = found != image.numbers.end() && found->second > 0 ? float(found->second) : 24.0f;
  for_each_row(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      FlowFrame::Step step = flow.step(std::size_t(y) * std::size_t(image.width) + std::size_t(x), 1);
      if (!step.known) step = flow.step(std::size_t(y) * std::size_t(image.width) + std::size_t(x), -1);
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
  for (Plane& plane : sum.light[0]) plane = Plane(frame.width, frame.height);   // 0
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

}  // namespace

void check_frame(const LightFrame& frame, const LightFrame& other) {
  if (other.width != frame.width || other.height != frame.height)
    throw InputError("frames of " + std::to_string(frame.width) + "x" + std::to_string(frame.height) + " and of " +
                     std::to_string(other.width) + "x" + std::to_string(other.height) + " pixels; all frames of a window have one size");
  if (other.layers != frame.layers || other.albedo[0].empty() != frame.albedo[0].empty())
    throw InputError("frames of a window have different layers; write all with the same --channels");
}

struct FrameFilter::State {
  const LightFrame& frame;
  const FlowFrame& flow;
  FilterOptions options;
  std::size_t before, after, added = 0;
  PlainWeights plain;                    ///< empty if noise is known
  std::optional<Collector> collector;

  bool by_value() const { return frame.noise != NoiseKnowledge::none; }
  /// Of a frame so many frames away.
  float weight(std::size_t away) const {
    constexpr float kEnd = 1.5f;   // standard deviations
    if (by_value() || away == 0) return 1;
    const float deviations = kEnd * float(away) / float(std::max(before, after));
    return std::exp(-0.5f * deviations * deviations);
  }
};

FrameFilter::FrameFilter(const Image& image, const WindowFrame& middle, std::size_t before, std::size_t after, const FilterOptions& options)
    : state_(new State{*middle.light, *middle.flow, options, before, after, 0, {}, {}}) {
  if (options.radius < 0 || options.radius > kMargin) throw std::invalid_argument("FrameFilter: radius");
  if (!state_->by_value()) state_->plain = plain_weights(image, state_->flow, options);
  state_->collector.emplace(middle, state_->weight(0), state_->by_value() ? nullptr : &state_->plain.in_time);
}

FrameFilter::~FrameFilter() = default;

void FrameFilter::add(const WindowFrame& frame) {
  State& state = *state_;
  check_frame(state.frame, *frame.light);
  if (state.added >= state.before + state.after) throw std::invalid_argument("FrameFilter: more frames than the window has");
  const bool is_after = state.added >= state.before;
  const std::size_t away = state.added - (is_after ? state.before : 0) + 1;
  if (away == 1) state.collector->start(state.flow, is_after ? 1 : -1);
  state.collector->add(frame, state.weight(away));
  ++state.added;
}

Image FrameFilter::finish(Image image) {
  State& state = *state_;
  const LightFrame& frame = state.frame;
  if (state.added != state.before + state.after) throw std::invalid_argument("FrameFilter: frames of the window are missing");
  const bool by_layers = !frame.layers[0].empty();
  const LayerSums before = by_layers ? sum_layers(image) : LayerSums{};
  Collected collected = state.collector->take();
  state.collector.reset();
  FitOptions fit_options;
  fit_options.radius = state.options.radius;
  fit_options.by_value = state.by_value();
  if (fit_options.by_value) compare_by_fit(frame, fit_options.radius, collected);
  else fit_options.reach2 = &state.plain.reach2;
  Fitted fitted = fit(frame, collected, fit_options);
  const Coverage coverage(image);
  unmix(frame, collected, coverage, fit_options.radius, int(1 + state.added), fitted);

  for (std::size_t l = 0; l < frame.layers.size(); ++l)
    for (std::size_t c = 0; c < 3; ++c) {
      if (fitted.light[l][c].empty()) continue;   // black before and after
      const EdgePlane light{fitted.light[l][c], fitted.other[l][c], frame.albedo[c]};
      std::vector<float>& values = float_channel(image, channel_name(frame.layers[l], c))->values;
      if (coverage.known()) resolve(light, coverage, frame.width, frame.height, values);
      else write_inside(frame, light, values);
    }
  if (coverage.known()) resolve_passing(frame, coverage, image);
  if (by_layers) renew_picture(before, sum_layers(image), image);
  leave_numbers(image);
  return image;
}

Image filter_frame(Image image, std::span<const WindowFrame> window, std::size_t middle, const FilterOptions& options) {
  FrameFilter filter(image, window[middle], middle, window.size() - 1 - middle, options);
  for (std::size_t i = middle; i > 0; --i) filter.add(window[i - 1]);
  for (std::size_t i = middle + 1; i < window.size(); ++i) filter.add(window[i]);
  return filter.finish(std::move(image));
}

}  // namespace tempolux
