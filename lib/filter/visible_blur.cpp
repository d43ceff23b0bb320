#include "lib/filter/visible_blur.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

namespace tempolux {
namespace {

constexpr double kSlowest = 0.01, kPerOctave = 4;   // deg/s
constexpr std::size_t kSpeeds = 80;                 // up to 2^20 times that

double speed_of(std::size_t index) { return kSlowest * std::exp2(double(index) / kPerOctave); }

}  // namespace

double VisibleBlur::retinal(double speed) {
  constexpr double kFollowed = 0.82, kDrift = 0.15, kFastest = 80;   // share; deg/s
  return std::max(kDrift, std::abs(speed - std::min(kFollowed * speed + kDrift, kFastest)));
}

double VisibleBlur::sensitivity(double frequency, double v) {
  constexpr double c0 = 1.14, c1 = 0.67, c2 = 1.7;
  const double octave = std::abs(std::log10(c2 * v / 3)), wave = 2 * std::numbers::pi * c1 * frequency;
  return c0 * (6.1 + 7.3 * octave * octave * octave) * c2 * v * wave * wave * std::exp(-2 * wave * (c2 * v + 2) / 45.9);
}

double VisibleBlur::cutoff(double v) {
  // From the peak on sensitivity falls.
  double low = 45.9 / (2 * std::numbers::pi * 0.67 * (1.7 * v + 2)), high = 100;
  if (sensitivity(low, v) <= 1) return low;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (sensitivity(middle, v) > 1 ? low : high) = middle;
  }
  return low;
}

VisibleBlur::VisibleBlur(double pixels_per_degree) : pixels_per_degree_(pixels_per_degree), slow_(speed_of(kSpeeds - 1)) {
  if (!(pixels_per_degree > 0)) throw std::invalid_argument("VisibleBlur: pixels per degree must be above 0");
  const double half_amplitude = std::sqrt(std::log(2.0) / 2) / std::numbers::pi;   // cycles
  for (std::size_t i = 0; i < kSpeeds; ++i) {
    const double seen = cutoff(retinal(speed_of(i)));
    sigma_.push_back(float(half_amplitude / seen * pixels_per_degree));
    constexpr double kOfBand = 0.9;
    if (seen <= kOfBand * pixels_per_degree / 2) slow_ = std::min(slow_, speed_of(i));
  }
}

float VisibleBlur::sigma(float pixels) const {
  const double speed = double(pixels) / pixels_per_degree_;
  const double index = speed > kSlowest ? std::log2(speed / kSlowest) * kPerOctave : 0;
  return sigma_[std::size_t(std::min(index, double(kSpeeds - 1)))];
}

}  // namespace tempolux
