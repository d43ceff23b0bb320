#include "lib/render/pixel_noise.h"

#include <cmath>

#include "lib/image/srgb.h"
#include "lib/render/pixels_around.h"

namespace tempolux {
namespace {

/// Shares of variances in own_variance(): of the variance between pixels, and of all light with edges. Samples of such
/// light are stratified in two numbers, so they reduce the variance by more than their number (docs/pixels.md).
constexpr double kBetween = 0.1, kSharp = 0.125;
/// k of wanted_samples() (docs/pixels.md).
constexpr double kStratified = 0.875;
/// Number of samples of a part that costs one shadow ray, if one sample has the standard deviation of the allowed
/// error.
constexpr double kAtError = 2.5;
constexpr double kOwn = 1.2;  ///< cost of a camera ray with its surface, in shadow rays

/// Pixels at edges of a frame that will be filtered get this many times the samples of an unfiltered frame. Pixels
/// inside surfaces get half of that, because the filter leaves about half as much of the squared error there. Compared
/// with 1 and 1, the median scene takes 6 % more samples and errs by 7 % less (docs/notebook/st-filter.md).
constexpr double kAtEdges = 1.8;

/// Number of first samples of the part onward: half of the others; but two if halves are kept, one for each half.
int first_onward(const FrameOptions& options) {
  const int n = options.samples;
  return std::max((n + 1) / 2, options.sample_halves ? std::min(n, 2) : 1);
}

}  // namespace

double sample_variance(double n, double sum, double square) {
  return n > 1 ? std::max(0.0, square - sum * sum / n) / (n - 1) : 0;
}

double allowed_error(double level, double picture, double pixel_error) {
  return pixel_error * std::sqrt(std::min(level, picture) * picture + 0.01 * picture * picture);
}

double wanted_samples(double sigma, double cost, double error) {
  return error > 0 ? kAtError * std::pow(sigma / (error * std::sqrt(cost)), kStratified) : 0;
}

double error_exponent() { return (1 - kStratified / 2) / kStratified; }

double error_for_variance(double times) { return std::pow(times, -error_exponent()); }

double stratified_rate() { return 2 / kStratified - 1; }

double error_for_samples(double times) { return std::pow(times, -1 / kStratified); }

PixelNoise::PixelNoise(const CameraView& view, const FrameOptions& options)
    : view_(view),
      options_(options),
      first_{options.samples, options.samples, first_onward(options)},
      first_half_((options.samples + 1) / 2),
      lattice_(std::max(1, int(std::sqrt(double(view.width()) * view.height() / kOnLattice)))),
      pixels_(std::size_t(view.width()) * std::size_t(view.height())) {
  lattice_ = std::min({lattice_, view.width(), view.height()});
  if (!options.mask.empty()) look_around_mask();
}

/// Sets looked_at_: the pixels of the mask, the pixels around them, and the pixels of the lattice.
void PixelNoise::look_around_mask() {
  const int width = view_.width(), height = view_.height();
  looked_at_.assign(options_.mask.size(), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      if (on_lattice(x, y) || options_.mask[at]) looked_at_[at] = 1;
      if (options_.mask[at])
        for_each_around(width, height, x, y, kWide, [&](std::size_t near, int, int) { looked_at_[near] = 1; });
    }
}

void PixelNoise::note(std::size_t pixel, const PixelSum& first, const PixelSum& second, std::uint64_t onward_rays) {
  const double n = options_.samples, a = first_half_, b = n - a;
  const auto both = [&](LayersT<double> PixelSum::*part) {
    return radiance_of(first.*part) + radiance_of(second.*part);
  };
  const double specular = PixelSum::specular(first.own) + PixelSum::specular(second.own);
  const double seen = both(&PixelSum::own) - specular, onward = both(&PixelSum::onward);
  Pixel& state = pixels_[pixel];
  state.mean = (both(&PixelSum::own) + both(&PixelSum::lit)) / n + onward / first_.onward;
  state.lit_difference = radiance_of(first.lit) / a - (b > 0 ? radiance_of(second.lit) / b : 0);
  state.seen = seen / n;
  state.seen_variance = sample_variance(n, seen, first.seen_square + second.seen_square);
  state.specular_variance = sample_variance(n, specular, first.specular_square + second.specular_square);
  state.onward = onward / first_.onward;
  state.onward_variance = sample_variance(first_.onward, onward, first.onward_square + second.onward_square);
  state.onward_rays = float(double(onward_rays) / first_.onward);
}

/// Variance of one sample of the part own, from the neighbours of the pixel.
/// - Layer specular contributes its mean variance within the neighbours.
/// - The light of the other layers has edges. It contributes kSharp of a sum: the mean variance within the neighbours,
///   plus the share kBetween (with one sample per pixel: all) of the variance between the neighbours that their samples
///   do not explain. If each neighbour's samples agree but the neighbours differ, an edge may run through this pixel
///   alone, such as the rim of a lamp that reaches into one row of pixels. The pixel's first samples may then miss the
///   bright part or overestimate it. The contribution is at most the square of white, because a lamp is shown as white.
///   If the lamp covers a share of a pixel, and all shares are equally likely, N samples all miss the lamp with the
///   probability 1 / (N + 1), and the picture is then wrong by white at most.
double PixelNoise::own_variance(int x, int y) const {
  double within = 0, n = 0, sum = 0, square = 0, specular = 0;
  for_each_around(view_.width(), view_.height(), x, y, kNearSharp, [&](std::size_t at, int, int) {
    const Pixel& pixel = pixels_[at];
    ++n;
    within += pixel.seen_variance;
    specular += pixel.specular_variance;
    sum += pixel.seen;
    square += pixel.seen * pixel.seen;
  });
  if (n == 0) return 0;
  within /= n;
  const double between = sample_variance(n, sum, square) - within / options_.samples;
  const double sharp = kSharp * (within + (options_.samples == 1 ? 1 : kBetween) * std::max(0.0, between));
  return std::min(sharp, white_ * white_) + specular / n;
}

/// Sums over the pixels around a pixel.
struct PixelNoise::Around {
  double n = 0, level = 0, lit = 0, lit_square = 0, onward = 0, onward_square = 0, within = 0, rays = 0;
  void add(const Pixel& pixel) {
    ++n;
    level += pixel.mean;
    lit += pixel.lit_difference;
    lit_square += pixel.lit_difference * pixel.lit_difference;
    onward += pixel.onward;
    onward_square += pixel.onward * pixel.onward;
    within += pixel.onward_variance;
    rays += double(pixel.onward_rays);
  }
};

/// Decides on each part separately. The variance of the part lit comes from the difference of the pixels' halves, which
/// includes the gain by stratification; with single samples it is the variance between pixels. The variance of the part
/// onward is the variance of single samples. Each of the two is the mean of a variance over the 24 closest pixels and a
/// variance over 80 pixels: if one sample in 12 finds a window, all 96 samples of the 24 pixels miss the window at one
/// place of 4000, and without the 80 pixels such a place would stay dark. If edges are given, a pixel at an edge is
/// compared with pixels at edges only, and a pixel inside a surface with pixels inside surfaces only, because at an
/// edge samples also differ by the surface that they see.
PartCounts PixelNoise::wanted_at(int x, int y, double times) const {
  const double a = first_half_, b = options_.samples - first_half_;
  Around near, wide;
  const auto look_around = [&](const auto& counts) {
    near = wide = {};
    for_each_around(view_.width(), view_.height(), x, y, kWide, [&](std::size_t at, int i, int j) {
      if (!counts(at)) return;
      wide.add(pixels_[at]);
      if (std::abs(i - x) <= kNearPixels && std::abs(j - y) <= kNearPixels) near.add(pixels_[at]);
    });
  };
  if (!options_.edges.empty()) {
    const std::uint8_t kind = options_.edges[std::size_t(y) * std::size_t(view_.width()) + std::size_t(x)];
    look_around([&](std::size_t at) { return options_.edges[at] == kind; });
    times *= kind ? kAtEdges : kAtEdges / 2;
  }
  if (near.n < 2) look_around([](std::size_t) { return true; });
  if (near.n == 0) return first_;
  const auto variance = [&](const auto& of) { return (of(near) + of(wide)) / 2; };
  const double lit_variance = variance([&](const Around& of) {
    return b > 0 ? of.lit_square / of.n * a * b / (a + b) : sample_variance(of.n, of.lit, of.lit_square);
  });
  const double onward_variance = variance([&](const Around& of) {
    return first_.onward > 1 ? of.within / of.n : sample_variance(of.n, of.onward, of.onward_square);
  });
  const double error = error_at(near.level / near.n);
  const auto wanted = [&](double variance_of_part, double cost, int first) {
    const double samples = times * wanted_samples(std::sqrt(variance_of_part), cost, error);
    return std::max(first, int(std::min(double(options_.adaptive_limit), samples)));
  };
  return {wanted(own_variance(x, y), kOwn, first_.own), wanted(lit_variance, 1, first_.lit),
          wanted(onward_variance, std::max(1.0, near.rays / near.n), first_.onward)};
}

double PixelNoise::cost_at(int x, int y, const PartCounts& samples) const {
  double n = 0, rays = 0;
  for_each_around(view_.width(), view_.height(), x, y, kNearPixels,
                  [&](std::size_t at, int, int) { ++n, rays += double(pixels_[at].onward_rays); });
  return kOwn * samples.own + samples.lit + std::max(1.0, n > 0 ? rays / n : 0) * samples.onward;
}

void PixelNoise::all_noted() {
  std::vector<double> means;
  for (int y = lattice_ / 2; y < view_.height(); y += lattice_)
    for (int x = lattice_ / 2; x < view_.width(); x += lattice_)
      means.push_back(pixels_[std::size_t(y) * std::size_t(view_.width()) + std::size_t(x)].mean);
  picture_ = mean_to_white(means);
  white_ = 1 / exposure_of(means);
}

}  // namespace tempolux
