#include "lib/warp/masking.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel_each.h"
#include "lib/core/statistics.h"

namespace tempolux {
namespace {

/// Number of standard errors above which a difference is not noise. The factor 1.5 is for interpolated pixels: linear
/// interpolation leaves a pixel (2/3)^2 of its variance on average, but does not reduce the variance of a mean over
/// many pixels, because neighbouring pixels then share noise.
constexpr double kStandardErrors = kCertain * 1.5;
/// Pixels on each side over which light is averaged. Keys of quality final have a relative error of .016 per pixel,
/// their difference .023. A difference of WarpOptions::light_share = .02 in the mean over n pixels is certain if
/// kStandardErrors .023 / sqrt(n) <= .02, so n = 26, about 5 x 5.
constexpr int kReach = 2;

std::array<int, 3> place_of(const std::vector<std::string>& names, const std::string& prefix) {
  std::array<int, 3> at{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto found = std::find(names.begin(), names.end(), prefix + "RGB"[c]);
    if (found == names.end()) return {-1, -1, -1};
    at[c] = int(found - names.begin());
  }
  return at;
}

float luminance_at(const float* colour, const std::array<int, 3>& at) {
  return luminance(Rgb(colour[at[0]], colour[at[1]], colour[at[2]]));
}

}  // namespace

Masking::Masking(const WarpTarget& target, std::span<const WarpKey> keys, const WarpOptions& options,
                 const std::vector<std::string>& names)
    : target_(target),
      keys_(keys),
      options_(options),
      rgb_(place_of(names, "")),
      specular_(place_of(names, "specular.")) {
  double sum = 0;
  std::size_t count = 0;
  for (const WarpKey& key : keys)
    for (std::size_t p = 0; p < key.view->key().seen().pixel_count(); ++p, ++count)
      sum += double(luminance_at(key.view->key().colour(p), rgb_));
  dark_ = float(0.1 * sum / double(count));
}

float Masking::luminance_of(const float* colour) const { return luminance_at(colour, rgb_); }
bool Masking::specular_matters(std::size_t pixel, const float* colour, const float* first, const float* second) const {
  if (specular_[0] < 0) return !target_.gloss.empty() && target_.gloss[pixel] != 0;
  if (judges_gloss() && first && second) return false;
  return luminance_at(colour, specular_) > float(options_.specular_share) * std::max(luminance_of(colour), dark_);
}

void Masking::mark_seen_gloss(const std::vector<std::vector<float>>& colour, std::array<std::vector<float>, 3>&& error,
                              std::vector<std::uint32_t>& why) const {
  const auto dark = [](const std::vector<float>& plane) {
    return std::all_of(plane.begin(), plane.end(), [](float e) { return e == 0; });
  };
  if (std::all_of(error.begin(), error.end(), dark)) return;  // a black picture has no visible error
  GlossInDoubt doubt{{}, std::move(error), std::vector<std::uint8_t>(why.size())};
  for (std::size_t c = 0; c < 3; ++c) doubt.picture[c] = colour[std::size_t(rgb_[c])];
  for (std::size_t p = 0; p < why.size(); ++p) doubt.counted[p] = why[p] == 0;
  const std::vector<float> probability = target_.see_gloss(doubt);
  for (std::size_t p = 0; p < why.size(); ++p)
    if (double(probability[p]) > options_.seen_probability) why[p] |= formats::why_specular;
}

bool Masking::edge_agrees(const float* first, const float* second) const {
  if (!first || !second) return false;
  const float least = float(options_.edge_share) * std::max(0.5f * (luminance_of(first) + luminance_of(second)), dark_);
  for (const int c : rgb_)
    if (std::abs(first[c] - second[c]) > least) return false;
  return true;
}

Masking::Spread Masking::spread(const float* mean, const float* square) const {
  Spread spread;
  note_light(mean, spread.mean);
  note_light(square, spread.square);
  return spread;
}

std::size_t Masking::edge_positions(Spread at, std::size_t count, Spread around) const {
  constexpr double kCentres = 9, kAcross = 3;  // pixel centres, and how many of them an edge separates from the others
  const double allowed =
      options_.edge_share * double(std::max(luminance(Rgb(at.mean[0], at.mean[1], at.mean[2])), dark_));
  double variance = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double mean = double(at.mean[c]);
    // Mean squared difference between the colours at the pixel centres and the pixel's colour.
    const double off = std::max(0.0, double(around.square[c]) - 2 * mean * double(around.mean[c]) + mean * mean);
    variance = std::max({variance, double(at.square[c]) - mean * mean, off * kCentres / kAcross / (2 * double(count))});
  }
  if (!(variance > 0)) return 1;
  const double n = std::pow(std::sqrt(variance) / allowed, 6.0 / 5);
  return n < 1e6 ? std::size_t(std::ceil(n)) : 1000000;
}

std::uint32_t Masking::of_moved_pixel(std::size_t pixel, const float* colour, const float* first,
                                      const float* second) const {
  std::uint32_t why = 0;
  if (target_.speed && double((*target_.speed)[pixel]) < options_.slow_deg_per_s) why |= formats::why_slow;
  if (specular_matters(pixel, colour, first, second)) why |= formats::why_specular;
  return why;
}

bool Masking::light_may_differ() const {
  return std::any_of(keys_.begin(), keys_.end(), [](const WarpKey& key) { return key.light_may_differ; });
}

void Masking::mark_changed_light(const std::array<std::vector<float>, 2>& light,
                                 std::vector<std::uint32_t>& why) const {
  const int width = target_.seen->width, height = target_.seen->height;
  const auto given = [&](std::size_t k, std::size_t p) { return k < keys_.size() && light[k][p] >= 0; };
  parallel_pixels(width, height, [&](int x, int y, std::size_t p) {
    if (!given(0, p) || !given(1, p)) {
      // With one key alone no comparison can show that its light is the target's light.
      for (std::size_t k = 0; k < keys_.size(); ++k)
        if (given(k, p) && keys_[k].light_may_differ) why[p] |= formats::why_changed_light;
      return;
    }
    // Mean and standard error of the keys' difference over the surrounding pixels that both keys show.
    double sum = 0, squares = 0, both = 0;
    int n = 0;
    for (int ny = std::max(y - kReach, 0); ny <= std::min(y + kReach, height - 1); ++ny)
      for (int nx = std::max(x - kReach, 0); nx <= std::min(x + kReach, width - 1); ++nx) {
        const std::size_t q = std::size_t(ny) * std::size_t(width) + std::size_t(nx);
        if (!given(0, q) || !given(1, q)) continue;
        const double a = double(light[0][q]), b = double(light[1][q]);
        sum += a - b;
        squares += (a - b) * (a - b);
        both += 0.5 * (a + b);
        ++n;
      }
    const double mean = sum / n, variance = n > 1 ? std::max(0.0, (squares - sum * mean) / (n - 1)) : 0;
    const double least = options_.light_share * std::max(both / n, double(dark_));
    if (std::abs(mean) > std::max(least, kStandardErrors * std::sqrt(variance / n)))
      why[p] |= formats::why_changed_light;
  });
}

}  // namespace tempolux
