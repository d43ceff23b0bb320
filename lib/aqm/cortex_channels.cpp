// lib/aqm/cortex_channels.cpp -- computes the channels with Fourier transforms.
#include "lib/aqm/cortex_channels.h"

#include <algorithm>
#include <cmath>

namespace tempolux::vision {
namespace {

using Complex = std::complex<float>;

constexpr int kBorder = 32;            ///< pixels, 1 / h_5: the reach of the base band's filter
constexpr int kTableSteps = 4096;      ///< steps of frequency from 0 to kTableEnd, linear between
constexpr double kTableEnd = 0.70711;  ///< c/px, at the corner of the spectrum

int padded(int n) { return 8 * fast_transform_size((n + 2 * kBorder + 7) / 8); }

/// Index of the value at place `at` of a period of `period`, with n values reflected at both ends.
int reflected(int at, int n, int period) {
  // A place outside the values belongs to the closer end: it follows the last value, or, since the period repeats, it
  // precedes the first one.
  const int place = at - n < period - at ? at : at - period;
  const int folded = ((place % (2 * n)) + 2 * n) % (2 * n);
  return folded < n ? folded : 2 * n - 1 - folded;
}

/// Upper edge of a band, c/px.
double upper_edge(int band) { return band == kBaseBand ? 1.0 / 24 : 4.0 / 3 * std::ldexp(1.0, 1 - band); }

}  // namespace

ChannelGrid::ChannelGrid(int w, int h) : width(w), height(h), padded_width(padded(w)), padded_height(padded(h)) {}

int ChannelGrid::step(int band) {
  constexpr std::array<int, kBands> steps{1, 1, 2, 4, 8, 8};
  return steps[std::size_t(band - 1)];
}

int ChannelGrid::columns(int band) const { return std::min((width - 1) / step(band) + 2, padded_width / step(band)); }
int ChannelGrid::rows(int band) const { return std::min((height - 1) / step(band) + 2, padded_height / step(band)); }

FourierArray<Complex> padded_spectrum(const FourierTransform& transform, const ChannelGrid& grid,
                                      const std::vector<float>& values) {
  FourierArray<float> picture(grid.padded_count());
  std::vector<int> column(std::size_t(grid.padded_width));
  for (int x = 0; x < grid.padded_width; ++x) column[std::size_t(x)] = reflected(x, grid.width, grid.padded_width);
  for (int y = 0; y < grid.padded_height; ++y) {
    const float* from =
        values.data() + std::size_t(reflected(y, grid.height, grid.padded_height)) * std::size_t(grid.width);
    float* to = picture.data() + std::size_t(y) * std::size_t(grid.padded_width);
    for (int x = 0; x < grid.padded_width; ++x) to[x] = from[column[std::size_t(x)]];
  }
  return transform.forward(picture, grid.padded_width, grid.padded_height);
}

std::vector<ChannelName> channel_names() {
  std::vector<ChannelName> names;
  for (int band = 1; band < kBands; ++band)
    for (int orientation = 1; orientation <= kOrientations; ++orientation) names.push_back({band, orientation});
  names.push_back({kBaseBand, 0});
  return names;
}

ChannelFilters::ChannelFilters(const ChannelGrid& grid, double pixels_per_degree,
                               const std::function<double(double)>& still)
    : grid_(grid), pixels_per_degree_(pixels_per_degree), radial_(kBands) {
  for (int band = 1; band <= kBands; ++band) {
    std::vector<double> seen(kTableSteps + 1);
    for (int i = 0; i <= kTableSteps; ++i) {
      const double frequency = kTableEnd * i / kTableSteps;
      seen[std::size_t(i)] = band_filter(band, frequency) * still(frequency * pixels_per_degree);
    }
    const double most = std::ranges::max(seen);
    most_[std::size_t(band - 1)] = most;
    for (const double value : seen) radial_[std::size_t(band - 1)].push_back(most > 0 ? float(value / most) : 0);
  }
}

double ChannelFilters::sensitivity(int band, double speed) const {
  const double frequency = band_frequency(band) * pixels_per_degree_,
               still = contrast_sensitivity(frequency, kDriftSpeed);
  return still > 0 ? most_[std::size_t(band - 1)] * (contrast_sensitivity(frequency, speed) / still) : 0;
}

float ChannelFilters::radial(int band, double frequency) const {
  const std::vector<float>& table = radial_[std::size_t(band - 1)];
  const double place = std::min(frequency / kTableEnd, 1.0) * kTableSteps;
  const int i = std::min(int(place), kTableSteps - 1);
  const float t = float(place - i);
  return (1 - t) * table[std::size_t(i)] + t * table[std::size_t(i) + 1];
}

/// The frequencies of a channel: their range, their weights, and their places in the channel's own spectrum.
struct ChannelFilters::Lobe {
  const ChannelFilters& filters;
  ChannelName name;
  int width, height, step, most_x, most_y;  ///< of the padded grid; most_x and most_y: largest |u| and |v| of the band
  double cosine, sine;                      ///< of the orientation's angle

  Lobe(const ChannelFilters& f, ChannelName n)
      : filters(f),
        name(n),
        width(f.grid_.padded_width),
        height(f.grid_.padded_height),
        step(ChannelGrid::step(n.band)),
        most_x(int(std::min(upper_edge(n.band), 0.5) * width)),
        most_y(int(std::min(upper_edge(n.band), 0.5) * height)),
        cosine(std::cos(orientation_angle(n.orientation))),
        sine(std::sin(orientation_angle(n.orientation))) {}

  /// In an oriented channel frequency (u, v) has weight 2 and its opposite 0. Nyquist's frequency is stored once for
  /// both signs, so it has weight 1.
  float weight(int u, int v) const {
    const double x = double(u) / width, y = double(v) / height, square = x * x + y * y;
    if (name.orientation == 0) return filters.radial(name.band, std::sqrt(square));
    const double along = cosine * x + sine * y;
    if (along <= 0 || along * along <= 0.75 * square) return 0;
    const double length = std::sqrt(square);
    const double share = (2 * std::abs(u) == width ? 0.5 : 1) * (2 * std::abs(v) == height ? 0.5 : 1);
    return float(2 * share * fan_filter(along / length)) * filters.radial(name.band, length);
  }

  /// The value at frequency (u, v), from the stored half of the spectrum.
  Complex at(const FourierArray<Complex>& spectrum, int u, int v) const {
    const auto row = [&](int r) {
      return std::size_t(r < 0 ? r + height : r >= height ? r - height : r) * std::size_t(width / 2 + 1);
    };
    return u >= 0 ? spectrum[row(v) + std::size_t(u)] : std::conj(spectrum[row(-v) + std::size_t(-u)]);
  }

  /// Calls add(index into the channel's spectrum, u, v, weight) for all frequencies whose weight is not 0.
  template <class Add>
  void each(const Add& add) const {
    const int columns = width / step, rows = height / step;
    const bool no_left = name.orientation > 1;  // orientations from -60 to 60 degrees have no frequency with u < 0
    for (int v = -most_y; v <= most_y; ++v) {
      const std::size_t row = std::size_t(((v % rows) + rows) % rows) * std::size_t(columns);
      for (int u = no_left ? 0 : -most_x; u <= most_x; ++u)
        if (const float w = weight(u, v); w != 0) add(row + std::size_t(((u % columns) + columns) % columns), u, v, w);
    }
  }
};

ChannelPair ChannelFilters::channel(const FourierTransform& transform, ChannelName name,
                                    const FourierArray<Complex>& first, const FourierArray<Complex>& second) const {
  const Lobe lobe(*this, name);
  const int columns = lobe.width / lobe.step, rows = lobe.height / lobe.step;
  const std::size_t count = std::size_t(columns) * std::size_t(rows);
  ChannelPair pair{FourierArray<Complex>(count), FourierArray<Complex>(count)};
  std::fill_n(pair.first.data(), count, Complex());
  std::fill_n(pair.second.data(), count, Complex());
  const float scale = 1 / float(grid_.padded_count());
  lobe.each([&](std::size_t to, int u, int v, float weight) {
    pair.first[to] += scale * weight * lobe.at(first, u, v);
    pair.second[to] += scale * weight * lobe.at(second, u, v);
  });
  transform.inverse(pair.first, columns, rows);
  transform.inverse(pair.second, columns, rows);
  return pair;
}

}  // namespace tempolux::vision
