#include "lib/render/frame_noise.h"

#include <algorithm>
#include <cmath>

#include "lib/core/random.h"
#include "lib/image/srgb.h"

namespace tempolux {
namespace {

constexpr double kEnough = 1024;  ///< pixels; the RMS of that many normally distributed numbers errs by 2.2 %
/// Limits of the edge of squares: pixels that are rendered twice cost at most 1/25 of the frame's rays, and at least
/// 1/64 because noise is not normally distributed.
constexpr int kLeastEdge = 5, kMostEdge = 8;

/// Means over the channels of squared differences, in linear radiance and in codes.
struct Squares {
  double linear = 0, codes = 0;
  Squares& operator+=(const Squares& o) {
    linear += o.linear, codes += o.codes;
    return *this;
  }
  Squares operator*(double f) const { return {linear * f, codes * f}; }
};

Squares squares(const Rgbd& a, const Rgbd& b, double exposure) {
  Squares sum;
  for (int c = 0; c < 3; ++c) {
    const double linear = a[c] - b[c], codes = srgb_code(a[c] * exposure) - srgb_code(b[c] * exposure);
    sum += Squares{linear * linear, codes * codes} * (1.0 / 3);
  }
  return sum;
}

/// Root of the mean of squared errors over pixels, and its standard error.
class Mean {
 public:
  void add(const Squares& error) {
    ++count_;
    sum_ += error;
    square_ += {error.linear * error.linear, error.codes * error.codes};
  }
  Noise noise() const {
    Noise noise;
    root(sum_.linear, square_.linear, noise.linear, noise.linear_error);
    root(sum_.codes, square_.codes, noise.codes, noise.codes_error);
    return noise;
  }

 private:
  void root(double sum, double square, double& value, double& error) const {
    if (count_ < 2) return;
    const double n = double(count_), mean = std::max(0.0, sum / n),
                 variance = std::max(0.0, square / n - sum * sum / (n * n)) / (n - 1);
    value = std::sqrt(mean);
    error = value > 0 ? std::sqrt(variance) / (2 * value)
                      : std::sqrt(std::sqrt(variance));  // error of a root: d sqrt(m) = dm / (2 sqrt(m))
  }
  std::size_t count_ = 0;
  Squares sum_, square_;
};

/// Means over pixels of the errors of the sum of all layers and of each layer.
struct ImageAndLayers {
  Mean image, layer[kLayerCount];
  /// Adds a pixel. error(colour) returns the squared error of colour(layers), the selected Rgbd of a pixel.
  template <class Error>
  void add(const Error& error) {
    image.add(error([](const Layers& layers) { return sum_of_layers<double>(layers); }));
    for (std::size_t l = 0; l < kLayerCount; ++l)
      layer[l].add(error([l](const Layers& layers) { return Rgbd(layers.value[l]); }));
  }
  FrameNoise noise(double exposure, std::size_t pixels) const {
    FrameNoise noise{image.noise(), 0, {}, exposure, pixels};
    for (std::size_t l = 0; l < kLayerCount; ++l) noise.layer[l] = layer[l].noise();
    return noise;
  }
};

/// Means over the channels of the sum of all layers, for each pixel of the mask.
std::vector<double> means_of(std::span<const Layers> pixels, std::span<const std::uint8_t> mask) {
  std::vector<double> means;
  means.reserve(pixels.size());
  for (std::size_t p = 0; p < pixels.size(); ++p)
    if (mask.empty() || mask[p]) means.push_back(channel_mean(sum_of_layers<double>(pixels[p])));
  return means;
}

}  // namespace

double exposure_of(std::span<const Layers> pixels, std::span<const std::uint8_t> mask) {
  return exposure_of(means_of(pixels, mask));
}

double mean_to_white(std::span<const Layers> pixels, std::span<const std::uint8_t> mask) {
  return mean_to_white(means_of(pixels, mask));
}

NoiseCheck::NoiseCheck(const CameraView& view, std::uint64_t seed, std::span<const std::uint8_t> mask)
    : seed_(mix64(seed ^ 0x6e6f697365ull)),
      mask_(mask),
      width_(view.width()),
      height_(view.height()),
      edge_(std::clamp(int(std::sqrt(double(width_) * height_ / kEnough)), kLeastEdge, kMostEdge)),
      columns_(width_ / edge_) {
  again_.resize(std::size_t(columns_) * std::size_t(height_ / edge_));
  again_halves_.resize(again_.size());
}

std::uint32_t NoiseCheck::slot(int x, int y) const {
  const int i = x / edge_, j = y / edge_;
  if (i >= columns_ || j >= height_ / edge_) return kNone;
  const auto index = std::uint32_t(j * columns_ + i);
  // A random place in each square: a grid of fixed places could coincide with tiles or grooves of the scene.
  const auto place = int(mix64(index ^ 0x636865636bull) % std::uint64_t(edge_ * edge_));
  return x % edge_ == place % edge_ && y % edge_ == place / edge_ ? index : kNone;
}

FrameNoise NoiseCheck::measure(const std::vector<Triple>& triples, double exposure) const {
  ImageAndLayers sums;
  double stored = 0;
  for (const Triple& of : triples) {
    stored += squares(sum_of_layers<double>(of.shown),
                      sum_of_layers<double>(of.shown) + sum_of_layers<double>(of.stored), exposure)
                  .codes;
    sums.add([&](const auto& colour) {
      const Rgbd shown = colour(of.shown), sampled = colour(of.sampled);
      Rgbd given(0.0);
      for (int c = 0; c < 3; ++c) given[c] = std::max(0.0, shown[c] - sampled[c]);
      const Rgbd again = colour(of.again) + given;
      Squares error = squares(shown, again, exposure);
      error += squares(sampled + given, again, exposure) * -0.5;
      error += squares(shown, shown + colour(of.stored), exposure);
      return error;
    });
  }
  FrameNoise noise = sums.noise(exposure, triples.size());
  noise.stored_codes = std::sqrt(stored / double(std::max<std::size_t>(1, triples.size())));
  return noise;
}

namespace {

/// Sums over pixels and channels of a layer.
struct ShareSums {
  double variance = 0, square = 0, fourth = 0;
  /// Effective number of pixels: the number of equal pixels that would give the same uncertainty.
  double count() const { return fourth > 0 ? square * square / fourth : 0; }
};

}  // namespace

std::array<double, kLayerCount> NoiseCheck::shares(std::vector<Twice>& pixels) {
  constexpr double kAlike = 6;       // pixels that the common ratio counts as: derived in frame_noise.h
  constexpr double kSeen = 7.0 / 6;  // the squared slope of the sRGB curve is L^(2 (1 / 2.4 - 1))
  std::array<ShareSums, kLayerCount> sums;
  ShareSums all;
  for (std::size_t l = 0; l < kLayerCount; ++l) {
    double mean = 0, typical = 0;
    for (const Twice& pixel : pixels)
      mean += channel_mean(Rgbd(pixel.once.value[l]) + Rgbd(pixel.again.value[l])) / double(pixels.size());
    const auto seen = [&](const Twice& pixel) {
      const double level = channel_mean(Rgbd(pixel.once.value[l]) + Rgbd(pixel.again.value[l])) + mean;
      return level > 0 ? std::pow(level, -kSeen) : 0;
    };
    const auto around = [&](const Twice& pixel) { return seen(pixel) * channel_mean(Rgbd(pixel.around.value[l])) / 8; };
    for (const Twice& pixel : pixels) typical += around(pixel) / double(pixels.size());
    for (const Twice& pixel : pixels) {
      const double local = around(pixel) + typical;
      if (!(local > 0)) continue;
      const Rgbd off = Rgbd(pixel.once.value[l]) - Rgbd(pixel.again.value[l]), d(pixel.first.value[l]),
                 e(pixel.second.value[l]);
      const double weight = seen(pixel) / std::sqrt(local), square = weight * channel_mean(d * d + e * e);
      sums[l].variance += weight * channel_mean(off * off);
      sums[l].square += square;
      sums[l].fourth += square * square;
    }
    all.variance += sums[l].variance, all.square += sums[l].square;
  }
  std::array<double, kLayerCount> shares;
  const double pooled = all.square > 0 ? std::min(1.0, all.variance / all.square) : 1;
  for (std::size_t l = 0; l < kLayerCount; ++l) {
    const double count = sums[l].count(),
                 own = sums[l].square > 0 ? std::min(1.0, sums[l].variance / sums[l].square) : pooled;
    shares[l] = (count * own + kAlike * pooled) / (count + kAlike);
  }
  return shares;
}

FrameNoise noise_of_halves(std::span<const Layers> mean, std::span<const Layers> a, std::span<const Layers> b) {
  const double exposure = exposure_of(mean, {});
  ImageAndLayers sums;
  for (std::size_t p = 0; p < a.size(); ++p)
    sums.add([&](const auto& colour) { return squares(colour(a[p]), colour(b[p]), exposure) * 0.25; });
  return sums.noise(exposure, a.size());
}

}  // namespace tempolux
