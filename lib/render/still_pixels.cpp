#include "lib/render/still_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "lib/core/parallel_each.h"
#include "lib/render/pixel_noise.h"

namespace tempolux {
namespace {

PathParts difference(const PathParts& now, const PathParts& before) {
  PathParts result;
  for (Layers PathParts::*part : {&PathParts::own, &PathParts::lit, &PathParts::onward}) {
    Layers& to = result.*part;
    for (std::size_t l = 0; l < kLayerCount; ++l) to.value[l] = (now.*part).value[l] - (before.*part).value[l];
    to.coverage = (now.*part).coverage - (before.*part).coverage;
    to.mirrored = (now.*part).mirrored - (before.*part).mirrored;
  }
  return result;
}

/// Sum of the absolute values of all layers, mean of the channels.
double size_of(const PathParts& parts) {
  double sum = 0;
  for (const Layers* layers : {&parts.own, &parts.lit, &parts.onward})
    for (const Rgb& radiance : layers->value)
      sum += (std::abs(double(radiance.r)) + std::abs(double(radiance.g)) + std::abs(double(radiance.b))) / 3;
  return sum;
}

/// First samples of a pixel at both moments.
struct FirstSamples {
  PixelSum half[2];    ///< of the differences
  double now = 0;      ///< sum of the radiance now
  double largest = 0;  ///< size of the largest difference
  std::uint64_t onward = 0;
};

FirstSamples first_samples(const CameraSampler& now, const CameraSampler& before, const PixelPass& pass,
                           RayCounts& counts) {
  std::vector<PathParts> samples;
  samples.reserve(std::size_t(pass.count.own));
  FirstSamples first;
  const std::uint64_t onward = counts.onward;
  for_each_sample(now, pass, nullptr, counts, [&](int, const PathParts& sample) { samples.push_back(sample); });
  first.onward = counts.onward - onward;
  for_each_sample(before, pass, nullptr, counts, [&](int i, const PathParts& sample) {
    const PathParts& other = samples[std::size_t(i)];
    const PathParts changed = difference(other, sample);
    first.half[pass.half(i)].add(changed);
    first.now += radiance_of(other.own) + radiance_of(other.lit) + radiance_of(other.onward);
    first.largest = std::max(first.largest, size_of(changed));
  });
  return first;
}

bool more(const PartCounts& wanted, const PartCounts& first) {
  return wanted.own > first.own || wanted.lit > first.lit || wanted.onward > first.onward;
}

}  // namespace

double StillPixels::share_anew() const {
  return anew.empty() ? 1 : double(std::ranges::count(anew, 1)) / double(anew.size());
}

StillPixels still_pixels(const CameraSampler& now, const CameraSampler& before, const FrameOptions& options) {
  PixelNoise noise(now.view, options);
  const PartCounts first = noise.first();
  const std::size_t pixels = std::size_t(now.view.width()) * std::size_t(now.view.height());
  StillPixels still{std::vector<std::uint8_t>(pixels, 1), std::vector<Layers>(pixels), {}};
  std::vector<float> level(pixels), largest(pixels);
  for_each_pixel(now.view, {}, still.rays, {}, [&](std::size_t pixel, int x, int y, RayCounts& counts) {
    const FirstSamples samples = first_samples(now, before, {pixel, x, y, {}, first}, counts);
    noise.note(pixel, samples.half[0], samples.half[1], samples.onward);
    level[pixel] = float(samples.now / first.own);
    noise.set_level(pixel, double(level[pixel]));
    largest[pixel] = float(samples.largest);
    const PixelSum sum = samples.half[0] + samples.half[1];
    PathParts mean;
    join(sum.own, 0, first.own, mean.own);
    join(sum.lit, 0, first.lit, mean.lit);
    join(sum.onward, 0, first.onward, mean.onward);
    still.change[pixel] = mean.sum();
  });
  noise.all_noted();
  parallel_each(pixels, 1024, [&](std::size_t pixel) {
    const int x = int(pixel % std::size_t(now.view.width())), y = int(pixel / std::size_t(now.view.width()));
    const bool lone = double(largest[pixel]) > first.own * noise.error_at(double(level[pixel]));
    still.anew[pixel] = lone || more(noise.wanted_at(x, y, 1), first);
  });
  return still;
}

void add_change(const StillPixels& still, Image& image) {
  const auto values = [&](const std::string& name) -> float* {
    Channel* channel = image.find(name);
    return channel && channel->ids.empty() ? channel->values.data() : nullptr;
  };
  std::array<std::array<float*, 3>, kLayerCount> layers{};
  std::array<float*, 3> sum{};
  bool all = true;
  for (std::size_t c = 0; c < 3; ++c) {
    sum[c] = values(std::string(1, "RGB"[c]));
    for (std::size_t l = 0; l < kLayerCount; ++l) {
      layers[l][c] = values(std::string(kLayerNames[l]) + "." + "RGB"[c]);
      all &= layers[l][c] != nullptr || l == std::size_t(Layer::volume);
    }
  }
  float* const alpha = values("A");
  parallel_each(still.anew.size(), 4096, [&](std::size_t p) {
    if (still.anew[p]) return;
    const Layers& change = still.change[p];
    for (std::size_t c = 0; c < 3; ++c) {
      float shown = 0;
      for (std::size_t l = 0; l < kLayerCount; ++l) {
        const float by = change.value[l][int(c)];
        if (float* const to = layers[l][c]) to[p] = std::max(0.0f, to[p] + by), shown += to[p];
        if (!all && sum[c]) sum[c][p] += by;
      }
      if (sum[c]) sum[c][p] = all ? shown : std::max(0.0f, sum[c][p]);
    }
    if (alpha) alpha[p] = std::clamp(alpha[p] + change.coverage, 0.0f, 1.0f);
  });
}

}  // namespace tempolux
