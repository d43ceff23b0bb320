#include "lib/render/pixel_variance.h"

#include <algorithm>

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

void SampleHalves::add(int rank, int count, const Layers& sample) {
  const bool second = count == 1 ? half[1].count < half[0].count : 2 * rank >= count;
  Sum& sum = half[second ? 1 : 0];
  const Rgb diffuse = sample[Layer::direct] + sample[Layer::caustic] + sample[Layer::indirect];
  sum.image += sample[Layer::emission] + sample[Layer::specular] + diffuse + sample[Layer::volume];
  sum.diffuse += diffuse;
  sum.count += 1;
}

SampleHalves& SampleHalves::operator+=(const SampleHalves& more) {
  for (int h = 0; h < 2; ++h) {
    half[h].image += more.half[h].image;
    half[h].diffuse += more.half[h].diffuse;
    half[h].count += more.half[h].count;
  }
  return *this;
}

Rgb SampleHalves::variance(Rgb Sum::*part) const {
  const double a = double(half[0].count), b = double(half[1].count);
  if (!(a > 0 && b > 0)) return Rgb(0.0f);
  Rgb result;
  for (int c = 0; c < 3; ++c) {
    const double difference = double((half[0].*part)[c]) / a - double((half[1].*part)[c]) / b;
    // A square beyond float32 is cut to its largest: a file holds no infinity.
    result[c] = float(std::min(difference * difference * a * b / ((a + b) * (a + b)), 3.4e38));
  }
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
