#include "lib/render/pixel_noise.h"

#include <cmath>

namespace tempolux {
namespace {

constexpr double kBetween = 0.1, kSharp = 0.5;   // of its variance: more samples there make less of the picture's error
constexpr double kStratified = 0.75, kTypical = 12;

}  // namespace

double sample_variance(double n, double sum, double square) { return n > 1 ? std::max(0.0, square - sum * sum / n) / (n - 1) : 0; }

double wanted_samples(double sigma, double level, double picture, double pixel_error) {
  const double error = pixel_error * (std::min(level, picture) + 0.1 * picture);
  return error > 0 ? kTypical * std::pow(sigma / (kTypical * error), kStratified) : 0;
}

PixelNoise::PixelNoise(const CameraView& view, const FrameOptions& options)
    : view_(view), options_(options), first_half_((options.samples + 1) / 2),
      lattice_(std::max(1, int(std::sqrt(double(view.width()) * view.height() / kOnLattice)))),
      pixels_(std::size_t(view.width()) * std::size_t(view.height())) {
  lattice_ = std::min({lattice_, view.width(), view.height()});
  if (!options.mask.empty()) look_around_mask();
}

void PixelNoise::look_around_mask() {
  const int width = view_.width(), height = view_.height();
  looked_at_.assign(options_.mask.size(), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      if (on_lattice(x, y)) looked_at_[at] = 1;
      if (!options_.mask[at]) continue;
      for (int j = std::max(0, y - kNear); j <= std::min(height - 1, y + kNear); ++j)
        for (int i = std::max(0, x - kNear); i <= std::min(width - 1, x + kNear); ++i)
          looked_at_[std::size_t(j) * std::size_t(width) + std::size_t(i)] = 1;
    }
}

void PixelNoise::note(std::size_t pixel, const PixelSum& first, const PixelSum& second) {
  const double n = options_.samples, a = first_half_, b = n - a;
  const double sharp = first.sharp + second.sharp;
  Pixel& state = pixels_[pixel];
  state.mean = (first.value() + second.value()) / n;
  state.sharp = sharp / n;
  state.sharp_variance = sample_variance(n, sharp, first.sharp_square + second.sharp_square);
  if (!options_.for_filter) state.smooth_difference = (first.value() - first.sharp) / a - (b > 0 ? (second.value() - second.sharp) / b : 0);
}

/// body(pixel) for the neighbours of a pixel, at most `near` away.
template <class Body>
void PixelNoise::for_each_neighbour(int x, int y, int near, const Body& body) const {
  for (int j = std::max(0, y - near); j <= std::min(view_.height() - 1, y + near); ++j)
    for (int i = std::max(0, x - near); i <= std::min(view_.width() - 1, x + near); ++i) {
      const std::size_t at = std::size_t(j) * std::size_t(view_.width()) + std::size_t(i);
      if (i != x || j != y) body(pixels_[at]);
    }
}

/// Variance of a sample, of all but what has edges, as far as stratification leaves it: by the difference of pixels' halves. Of
/// single samples it is the variance between pixels. What has edges may agree in a few samples and be wrong:
/// Pixel::sharp_variance counts in full.
double PixelNoise::smooth_variance(int x, int y) const {
  const double a = first_half_, b = options_.samples - first_half_;
  double n = 0, sum = 0, square = 0;
  for_each_neighbour(x, y, kNear, [&](const Pixel& pixel) {
    ++n;
    sum += pixel.smooth_difference;
    square += pixel.smooth_difference * pixel.smooth_difference;
  });
  if (b == 0) return sample_variance(n, sum, square);
  return n > 0 ? square / n * a * b / (a + b) : 0;
}

/// Of what has edges: that of the neighbours' samples, and a share of the variance between neighbours beyond what their
/// samples leave. Where these are all of one piece and differ, an edge may run through this pixel alone: the rim of a
/// lamp that just reaches into a row of dark pixels, of which first samples meet nothing, or many times what there is.
double PixelNoise::sharp_variance(int x, int y) const {
  double within = 0, n = 0, sum = 0, square = 0;
  for_each_neighbour(x, y, kNearSharp, [&](const Pixel& pixel) {
    ++n;
    within += pixel.sharp_variance;
    sum += pixel.sharp;
    square += pixel.sharp * pixel.sharp;
  });
  if (n == 0) return 0;
  within /= n;
  const double between = sample_variance(n, sum, square) - within / options_.samples;
  return within + (options_.samples == 1 ? 1 : kBetween) * std::max(0.0, between);
}

double PixelNoise::level_around(int x, int y) const {
  double level = 0;
  int n = 0;
  for_each_neighbour(x, y, kNear, [&](const Pixel& pixel) {
    ++n;
    level += pixel.mean;
  });
  return n > 0 ? level / n : 0;
}

std::vector<int> PixelNoise::missing_samples() {
  double all = 0, n = 0;
  for (int y = lattice_ / 2; y < view_.height(); y += lattice_)
    for (int x = lattice_ / 2; x < view_.width(); x += lattice_) {
      all += pixels_[std::size_t(y) * std::size_t(view_.width()) + std::size_t(x)].mean;
      ++n;
    }
  picture_ = all / std::max(1.0, n);
  std::vector<int> missing(pixels_.size());
  RayCounts none;
  for_each_pixel(view_, options_, none, {}, [&](std::size_t pixel, int x, int y, RayCounts&) {
    const double sigma = std::sqrt(smooth_variance(x, y) + kSharp * sharp_variance(x, y));
    const double wanted = std::min(wanted_samples(sigma, level_around(x, y), picture_, options_.pixel_error), double(options_.adaptive_limit));
    missing[pixel] = std::max(0, int(wanted) - options_.samples);
  });
  return missing;
}

}  // namespace tempolux
