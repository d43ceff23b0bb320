#include "lib/render/pixel_variance.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"

namespace tempolux {
namespace {

constexpr std::size_t kChunk = 4096;   ///< pixels

bool asked(const std::vector<std::string>& channels, const char* name) {
  return std::find(channels.begin(), channels.end(), name) != channels.end();
}

void add_variance(const std::vector<SampleHalves>& halves, Rgb SampleHalves::Sum::*part, const std::string& layer, Image& image) {
  const std::size_t first_channel = image.channels.size();
  for (const char* name : {".R", ".G", ".B"}) image.add(layer + name);
  parallel_chunks(halves.size(), kChunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      const Rgb variance = halves[p].variance(part);
      for (int c = 0; c < 3; ++c) image.channels[first_channel + std::size_t(c)].values[p] = variance[c];
    }
  });
}

}  // namespace

void SampleHalves::Sum::add(const Layers& sample, float samples) {
  const Rgb scattered = sample[Layer::direct] + sample[Layer::caustic] + sample[Layer::indirect];
  image += sample[Layer::emission] + sample[Layer::specular] + scattered + sample[Layer::volume];
  diffuse += scattered;
  count += samples;
}

void SampleHalves::add(int rank, int count, const PathParts& sample, const PathEffort& effort) {
  const bool second = count == 1 ? half[1].own.count < half[0].own.count : 2 * rank >= count;
  Half& to = half[second ? 1 : 0];
  to.own.add(sample.own, 1);
  to.lit.add(sample.lit, float(effort.lit));
  to.onward.add(sample.onward, float(effort.onward));
}

SampleHalves& SampleHalves::operator+=(const SampleHalves& more) {
  for (int h = 0; h < 2; ++h)
    for (Sum Half::*part : {&Half::own, &Half::lit, &Half::onward}) {
      Sum& sum = half[h].*part;
      sum.image += (more.half[h].*part).image;
      sum.diffuse += (more.half[h].*part).diffuse;
      sum.count += (more.half[h].*part).count;
    }
  return *this;
}

Rgb SampleHalves::variance(Rgb Sum::*of) const {
  double error[3] = {0, 0, 0};
  for (Sum Half::*part : {&Half::own, &Half::lit, &Half::onward}) {
    const Sum &first = half[0].*part, &second = half[1].*part;
    const double a = double(first.count), b = double(second.count);
    if (!(a > 0 && b > 0)) continue;
    for (int c = 0; c < 3; ++c) error[c] += (double((first.*of)[c]) / a - double((second.*of)[c]) / b) * std::sqrt(a * b) / (a + b);
  }
  Rgb result;
  // A square beyond float32 is cut to its largest: a file holds no infinity.
  for (int c = 0; c < 3; ++c) result[c] = float(std::min(error[c] * error[c], 3.4e38));
  return result;
}

bool wants_sample_halves(const std::vector<std::string>& channels) {
  return asked(channels, "variance") || asked(channels, "diffuse.variance") || asked(channels, "samples");
}

void add_variance_channels(const std::vector<SampleHalves>& halves, const std::vector<std::string>& channels, Image& image) {
  if (asked(channels, "variance")) add_variance(halves, &SampleHalves::Sum::image, "variance", image);
  if (asked(channels, "diffuse.variance")) add_variance(halves, &SampleHalves::Sum::diffuse, "diffuse.variance", image);
  if (!asked(channels, "samples")) return;
  std::vector<float>& samples = image.add("samples").values;
  for (std::size_t p = 0; p < halves.size(); ++p) samples[p] = halves[p].samples();
}

}  // namespace tempolux
