#include "lib/render/pixel_variance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/image/channel_groups.h"
#include "lib/render/frame_renderer.h"

namespace tempolux {
void SampleHalves::add(int h, const PathParts& sample, const PathEffort& effort) {
  const std::array radiance{&sample.own, &sample.lit, &sample.onward};
  const std::array count{1u, effort.lit, effort.onward};
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    half[std::size_t(h)][i].radiance += *radiance[i];
    half[std::size_t(h)][i].count += float(count[i]);
  }
}

SampleHalves& SampleHalves::operator+=(const SampleHalves& more) {
  for (std::size_t h = 0; h < 2; ++h)
    for (std::size_t i = 0; i < half[h].size(); ++i) {
      half[h][i].radiance += more.half[h][i].radiance;
      half[h][i].count += more.half[h][i].count;
    }
  return *this;
}

Rgb SampleHalves::difference(std::size_t l) const {
  Rgb sum(0.0f);
  for (std::size_t i = 0; i < half[0].size(); ++i) {
    const Sum &first = half[0][i], &second = half[1][i];
    const float a = first.count, b = second.count;
    if (a > 0 && b > 0)
      sum += (first.radiance.value[l] * (1 / a) - second.radiance.value[l] * (1 / b)) * (std::sqrt(a * b) / (a + b));
  }
  return sum;
}

Rgb SampleHalves::mean(std::size_t l) const {
  Rgb mean(0.0f);
  for (std::size_t i = 0; i < half[0].size(); ++i)
    if (const float count = half[0][i].count + half[1][i].count; count > 0)
      mean += (half[0][i].radiance.value[l] + half[1][i].radiance.value[l]) * (1 / count);
  return mean;
}

Rgb SampleHalves::variance(std::span<const Layer> layers) const {
  Rgb sum(0.0f), result;
  for (const Layer layer : layers) sum += difference(std::size_t(layer));
  // Squares above float32's range are cut to its largest value: a file holds no infinity.
  for (int c = 0; c < 3; ++c) result[c] = float(std::min(double(sum[c]) * double(sum[c]), 3.4e38));
  return result;
}

bool wants_sample_halves(const std::vector<std::string>& channels) {
  return asked(channels, "variance") || asked(channels, "diffuse.variance") || asked(channels, "samples") ||
         asked(channels, "halves");
}

namespace {

/// LAYER.noise of a pixel that shows the radiance `shown`, without noise of records and photons. share:
/// LayerImage::difference_share.
Rgb noise_of(const SampleHalves& halves, std::size_t l, float share, const Rgb& shown) {
  Rgb difference = halves.difference(l);
  const Rgb taken = halves.mean(l) - shown;
  for (int c = 0; c < 3 && channel_sum(taken) > 0; ++c)
    difference[c] = std::copysign(std::max(0.0f, std::abs(difference[c]) - std::max(0.0f, taken[c])), difference[c]);
  return difference * std::sqrt(share);
}

}  // namespace

void add_variance_channels(const LayerImage& layers, const std::vector<std::string>& channels, Image& image) {
  const std::vector<SampleHalves>& halves = layers.sample_halves;
  if (asked(channels, "variance"))
    add_colour("variance.", image, [&](std::size_t p) { return halves[p].variance(kImageLayers); });
  if (asked(channels, "diffuse.variance"))
    add_colour("diffuse.variance.", image, [&](std::size_t p) { return halves[p].variance(kDiffuseLayers); });
  if (asked(channels, "halves")) {
    std::vector<float>& confirmed = image.add("halves.confirmed").values;
    std::copy(layers.confirmed.begin(), layers.confirmed.end(), confirmed.begin());
    for (std::size_t l = 0; l < kLayerCount; ++l)
      if (layers.media || l != std::size_t(Layer::volume))
        add_colour(std::string(kLayerNames[l]) + ".noise.", image, [&](std::size_t p) {
          const Rgb noise = noise_of(halves[p], l, float(layers.difference_share[l]), layers.pixels[p].value[l]);
          const Rgb* stored = layers.stored_noise.empty() ? nullptr : layers.stored_noise[p].of(Layer(l));
          return stored ? noise + *stored : noise;
        });
  }
  if (!asked(channels, "samples")) return;
  std::vector<float>& samples = image.add("samples").values;
  for (std::size_t p = 0; p < halves.size(); ++p) samples[p] = halves[p].samples();
}

}  // namespace tempolux
