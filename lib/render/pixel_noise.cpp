#include "lib/render/pixel_noise.h"

#include <cmath>

namespace tempolux {
namespace {

constexpr double kBetween = 0.1, kSharp = 0.5;   // of its variance: more samples there make less of the picture's error
// Samples that are stratified err as n^(-5/6) or so. The least error for a number of samples has n ~ sigma^(2 / (1 + 10/6)).
constexpr int kLightsTogether = 4;     // samples of the lights at a place where only they are uncertain
constexpr double kStratified = 0.75, kTypical = 12;
constexpr double kOwn = 4;             // pixel errors by which one sample of a dot may change it
constexpr double kSpot = 2;            // times the samples it got that a pixel would ask for by all of them, and stands out

}  // namespace

float PixelNoise::seen_around(int x, int y) const {
  float sampled = 0, seen = 0;
  for_each_neighbour(x, y, kNear, [&](std::size_t at) {
    sampled += pixels_[at].sampled;
    seen += pixels_[at].seen;
  });
  return sampled > 0 ? seen / sampled : 0;
}

/// Variance of a sample, of all but what has edges, as far as stratification leaves it: by the difference of a pixel's
/// halves. What has edges may agree in a few samples and be wrong: PixelState::sharp_variance counts in full.
double PixelNoise::smooth_variance(std::size_t pixel, int x, int y) const {
  const PixelState& state = pixels_[pixel];
  const double a = first_half_, b = options_.samples - first_half_;
  double difference = double(state.difference);
  if (controlled_) difference -= double(seen_around(x, y) * state.noise_difference);
  return difference * difference * a * b / (a + b);
}

/// Of what has edges: that of the neighbours' samples, and a share of the variance between neighbours beyond what their
/// samples leave. Where these are all of one piece and differ, an edge may run through this pixel alone: the rim of a
/// lamp that just reaches into a row of dark pixels, of which first samples meet nothing, or many times what there is.
double PixelNoise::sharp_variance(int x, int y) const {
  double within = 0, sum = 0, square = 0;
  int n = 0;
  for_each_neighbour(x, y, kNearSharp, [&](std::size_t at) {
    const PixelState& state = pixels_[at];
    ++n;
    within += state.sharp_variance;
    sum += state.sharp;
    square += state.sharp * state.sharp;
  });
  if (n == 0) return 0;
  within /= n;
  if (n == 1) return within;
  const double between = (square - sum * sum / n) / (n - 1) - within / options_.samples;
  return within + kBetween * std::max(0.0, between);
}

/// Do the pixel and the eight around it see one matte surface each? Then it is its light that is uncertain, not which place of
/// it is seen.
bool PixelNoise::is_plain(int x, int y) const {
  for (int j = std::max(0, y - 1); j <= std::min(view_.height() - 1, y + 1); ++j)
    for (int i = std::max(0, x - 1); i <= std::min(view_.width() - 1, x + 1); ++i)
      if (!pixels_[std::size_t(j) * std::size_t(view_.width()) + std::size_t(i)].plain) return false;
  return true;
}

double PixelNoise::level_around(int x, int y) const {
  double level = 0;
  int n = 0;
  for_each_neighbour(x, y, kNear, [&](std::size_t at) {
    ++n;
    level += double(pixels_[at].mean);
  });
  return n > 0 ? level / n : 0;
}

double PixelNoise::wanted_samples(double sigma, double level) const {
  const double error = options_.pixel_error * (std::min(level, picture_) + 0.1 * picture_);
  return error > 0 ? kTypical * std::pow(sigma / (kTypical * error), kStratified) : 0;
}

std::vector<int> PixelNoise::missing_samples() {
  double all = 0;
  for (const PixelState& state : pixels_) all += double(state.mean);
  picture_ = all / double(std::max<std::size_t>(1, pixels_.size()));
  std::vector<double> smooth(pixels_.size());
  RayCounts none;
  for_each_pixel(view_, options_, none, {},
                 [&](std::size_t pixel, int x, int y, RayCounts&) { smooth[pixel] = smooth_variance(pixel, x, y); });
  std::vector<int> missing(pixels_.size());
  for_each_pixel(view_, options_, none, {}, [&](std::size_t pixel, int x, int y, RayCounts&) {
    double pooled = 0;
    int n = 0;
    for_each_neighbour(x, y, kNear, [&](std::size_t at) {
      ++n;
      pooled += smooth[at];
    });
    if (n == 0) return;   // a picture of one pixel
    const double sigma = std::sqrt(pooled / n + kSharp * sharp_variance(x, y));
    const double wanted = wanted_samples(sigma, level_around(x, y));
    const int more = std::clamp(int(std::min(wanted, double(options_.adaptive_limit))) - options_.samples, 0, options_.adaptive_limit);
    const int lights = pixels_[pixel].lights = is_plain(x, y) ? kLightsTogether : 1;
    missing[pixel] = more > 0 ? std::max(1, (more + lights / 2) / lights) * lights : 0;
    if (controlled_) ask_for_own(pixel, x, y, options_.samples + missing[pixel]);
  });
  return missing;
}

/// Of the light that large lights send to a plain pixel: did its first samples see some and miss some, where
/// its neighbours call for few more? Then it would stand out as a dot. Its own further samples would take light from the
/// edges of shadows, or give them some: that is shared out again among its neighbours on the same surface.
void PixelNoise::ask_for_own(std::size_t pixel, int x, int y, int samples) {
  PixelState& state = pixels_[pixel];
  const int wanted = int(std::min(double(options_.adaptive_limit), 1 / (kOwn * options_.pixel_error)));
  if (state.lights == 1 || samples >= wanted || !(state.seen > 0 && state.seen < state.sampled)) return;
  if (count_heirs(pixel, x, y) > 0) state.own = (wanted - samples + state.lights - 1) / state.lights * state.lights;
}

int PixelNoise::spot_samples(std::size_t pixel, int x, int y, const PixelSum& further, int samples) const {
  const PixelState& state = pixels_[pixel];
  const double first = options_.samples, sum = state.sharp * first + further.sharp,
               square = state.sharp_variance * (first - 1) + state.sharp * state.sharp * first + further.sharp_square;
  const double variance = std::max(0.0, square - sum * sum / samples) / std::max(1, samples - 1);
  const double wanted = std::min(wanted_samples(std::sqrt(variance), level_around(x, y)), double(options_.adaptive_limit));
  return wanted > kSpot * samples && count_heirs(pixel, x, y) > 0 ? int(wanted) - samples : 0;
}

int PixelNoise::count_heirs(std::size_t pixel, int x, int y) const {
  int count = 0;
  for_each_heir(pixel, x, y, [&](std::size_t) { ++count; });
  return count;
}

}  // namespace tempolux
