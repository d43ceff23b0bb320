// lib/aqm/visible_difference.cpp -- computes the map of detection probabilities.
#include "lib/aqm/visible_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "lib/aqm/cortex_channels.h"
#include "lib/core/parallel.h"
#include "lib/core/parallel_each.h"

namespace tempolux::vision {
namespace {

/// Receptor responses to both pictures minus their common mean, and that mean.
struct Responses {
  std::vector<float> first, second;
  double mean = 0;
};

Responses responses_of(const DisplayedPair& pair) {
  Responses out{pair.first, pair.second, 0};
  parallel_each(pair.first.size(), 1 << 15, [&](std::size_t i) {
    float& a = out.first[i];
    float& b = out.second[i];
    a = float(receptor_response(a));
    b = float(receptor_response(b));
    if (!pair.counted.empty() && !pair.counted[i]) a = b = 0.5f * (a + b);
  });
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < out.first.size(); ++i)
    if (pair.counted.empty() || pair.counted[i]) sum += double(out.first[i]) + double(out.second[i]), count += 2;
  out.mean = count ? sum / double(count) : 0;
  for (std::vector<float>* picture : {&out.first, &out.second})
    for (float& value : *picture) value -= float(out.mean);  // keeps digits: no channel contains frequency 0
  return out;
}

/// Means of a picture over squares, from cumulative sums.
class SquareMeans {
 public:
  SquareMeans(const std::vector<float>& values, int width, int height)
      : width_(width), height_(height), sums_(std::size_t(width + 1) * std::size_t(height + 1), 0) {
    for (int y = 0; y < height; ++y) {
      double row = 0;
      for (int x = 0; x < width; ++x) {
        row += double(values[std::size_t(y) * std::size_t(width) + std::size_t(x)]);
        sums_[at(x + 1, y + 1)] = sums_[at(x + 1, y)] + row;
      }
    }
  }
  /// Mean over the pixels within `radius` columns and rows of (x, y) inside the picture; (x, y) is clamped to the
  /// picture.
  double mean(int x, int y, int radius) const {
    x = std::min(x, width_ - 1), y = std::min(y, height_ - 1);
    const int left = std::max(x - radius, 0), right = std::min(x + radius + 1, width_);
    const int top = std::max(y - radius, 0), bottom = std::min(y + radius + 1, height_);
    const double sum =
        sums_[at(right, bottom)] - sums_[at(left, bottom)] - sums_[at(right, top)] + sums_[at(left, top)];
    return sum / (double(right - left) * double(bottom - top));
  }

 private:
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width_ + 1) + std::size_t(x); }
  int width_, height_;
  std::vector<double> sums_;
};

/// Factors from a band's amplitude to multiples of the threshold, at each sample.
using BandGains = std::array<std::vector<float>, kBands>;

/// Factors from responses to multiples of the threshold: the sensitivity at the local speed, divided by the response
/// to unit contrast, and scaled so that a grating at its threshold is seen with probability 1/2. `speed` is the speed
/// across the retina; empty: the sensitivity to still pictures.
BandGains band_gains(const ChannelGrid& grid, const ChannelFilters& filters, const std::vector<float>& speed,
                     double response_per_contrast) {
  BandGains gains;
  const double scale = kHalfSeen / response_per_contrast;
  const SquareMeans means = speed.empty() ? SquareMeans({}, 0, 0) : SquareMeans(speed, grid.width, grid.height);
  for (int band = 1; band <= kBands; ++band) {
    const int columns = grid.columns(band), rows = grid.rows(band), step = ChannelGrid::step(band);
    const int radius = int(0.5 / band_frequency(band));  // half a period
    std::vector<float>& gain = gains[std::size_t(band - 1)];
    gain.assign(std::size_t(columns) * std::size_t(rows), float(scale * filters.sensitivity(band, kDriftSpeed)));
    if (speed.empty()) continue;
    parallel_pixels(columns, rows, [&](int x, int y, std::size_t p) {
      const double around = std::max(means.mean(x * step, y * step, radius), kDriftSpeed);
      gain[p] = float(scale * filters.sensitivity(band, around));
    });
  }
  return gains;
}

std::vector<float> retinal_speeds(const std::vector<float>& speed, Gaze gaze) {
  std::vector<float> retinal(speed.size());
  for (std::size_t i = 0; i < speed.size(); ++i) retinal[i] = float(retinal_speed(double(speed[i]), gaze));
  return retinal;
}

/// threshold_elevation() in single precision. Slope 1, the most frequent one, needs no powers: the elevation is then
/// (1 + (6 contrast)^4)^(1/4) (docs/methods/vision.md).
float elevation(float contrast, double slope) {
  if (slope != 1) return float(threshold_elevation(double(contrast), slope));
  const float masked = 6 * contrast, square = masked * masked;
  return std::sqrt(std::sqrt(1 + square * square));
}

/// (difference / threshold)^3.5 at each sample of a channel inside the picture.
FourierArray<float> channel_terms(const ChannelGrid& grid, ChannelName name, const ChannelPair& pair,
                                  const std::vector<float>& gains) {
  const int columns = grid.columns(name.band), rows = grid.rows(name.band),
            stride = grid.padded_width / ChannelGrid::step(name.band);
  const double slope = masking_slope(name.band);
  FourierArray<float> terms(std::size_t(columns) * std::size_t(rows));
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const std::size_t from = std::size_t(y) * std::size_t(stride) + std::size_t(x),
                        to = std::size_t(y) * std::size_t(columns) + std::size_t(x);
      const std::complex<float> a = pair.first[from], b = pair.second[from];
      const float difference = gains[to] * std::sqrt(std::norm(a - b));
      // The picture with the weaker contrast masks.
      const float mask = gains[to] * std::sqrt(std::min(std::norm(a), std::norm(b)));
      const float ratio = difference / elevation(mask, slope);
      static_assert(kPsychometricSlope == 3.5);
      terms[to] = ratio * ratio * ratio * std::sqrt(ratio);
    }
  return terms;
}

using BandTerms = std::array<std::vector<float>, kBands>;  ///< summed over the orientations of each band

BandTerms all_terms(const ChannelGrid& grid, const Responses& responses, const ChannelFilters& filters,
                    const BandGains& gains) {
  const FourierTransform transform;
  std::array<std::optional<FourierArray<std::complex<float>>>, 2> spectra;
  parallel_chunks(2, 1, [&](std::size_t i, std::size_t) {
    spectra[i] = padded_spectrum(transform, grid, i ? responses.second : responses.first);
  });
  const std::vector<ChannelName> names = channel_names();
  BandTerms sums;
  parallel_ordered(
      names.size(), std::size_t(parallel_thread_count()) + 1,
      [&](std::size_t i) -> std::shared_ptr<void> {
        const ChannelPair pair = filters.channel(transform, names[i], *spectra[0], *spectra[1]);
        return std::make_shared<FourierArray<float>>(
            channel_terms(grid, names[i], pair, gains[std::size_t(names[i].band - 1)]));
      },
      [&](std::size_t i, void* made) {
        const auto& terms = *static_cast<FourierArray<float>*>(made);
        std::vector<float>& sum = sums[std::size_t(names[i].band - 1)];
        if (sum.empty()) sum.assign(terms.size(), 0);
        for (std::size_t n = 0; n < terms.size(); ++n) sum[n] += terms[n];
      });
  return sums;
}

/// A band's sum at pixel (x, y), interpolated linearly between its samples.
float term_at(const ChannelGrid& grid, int band, const std::vector<float>& terms, int x, int y) {
  const int step = ChannelGrid::step(band), columns = grid.columns(band), rows = grid.rows(band);
  const int left = x / step, top = y / step, right = std::min(left + 1, columns - 1),
            bottom = std::min(top + 1, rows - 1);
  const float tx = float(x % step) / float(step), ty = float(y % step) / float(step);
  const auto at = [&](int u, int v) { return terms[std::size_t(v) * std::size_t(columns) + std::size_t(u)]; };
  return (1 - ty) * ((1 - tx) * at(left, top) + tx * at(right, top)) +
         ty * ((1 - tx) * at(left, bottom) + tx * at(right, bottom));
}

/// The luminance that gives this response.
double luminance_of(double response) { return std::pow(12.6 * response / (100 - response), 1 / 0.37); }

}  // namespace

Detection detection_map(const DisplayedPair& pair, const std::vector<float>& speed, const Viewing& viewing) {
  Detection result{std::vector<float>(pair.first.size(), 0), 0};
  const Responses responses = responses_of(pair);
  result.adaptation_luminance = luminance_of(responses.mean);
  const double contrast_response = response_per_log_luminance(responses.mean);
  if (!(contrast_response > 0)) return result;  // both pictures are black
  const ChannelGrid grid(pair.width, pair.height);
  const double ppd = viewing.pixels_per_degree, area = double(pair.width) * double(pair.height) / (ppd * ppd);
  const ChannelFilters filters(grid, ppd, [&](double frequency) {
    return speed.empty() ? static_contrast_sensitivity(frequency, result.adaptation_luminance, area, viewing.distance)
                         : contrast_sensitivity(frequency, kDriftSpeed);
  });
  const BandGains gains = band_gains(grid, filters, retinal_speeds(speed, viewing.gaze), contrast_response);
  const BandTerms terms = all_terms(grid, responses, filters, gains);
  parallel_pixels(pair.width, pair.height, [&](int x, int y, std::size_t i) {
    if (!pair.counted.empty() && !pair.counted[i]) return;
    if (std::abs(double(pair.first[i]) - double(pair.second[i])) < kLeastDifference) return;
    float sum = 0;
    for (int band = 1; band <= kBands; ++band) sum += term_at(grid, band, terms[std::size_t(band - 1)], x, y);
    result.probability[i] = float(detection_probability(double(sum)));
  });
  return result;
}

}  // namespace tempolux::vision
