// lib/aqm/vision_model.cpp -- formulas of the vision model; docs/methods/vision.md lists their sources.
#include "lib/aqm/vision_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tempolux::vision {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFastestTracked = 80;  ///< deg/s: eyes do not follow faster motion [Daly 1998]
constexpr double kUsefulBand = 0.9;     ///< share of a display's highest frequency

/// h of a band's inner mesa, 2^-band.
double inner(int band) { return std::ldexp(1.0, -band); }

constexpr double kBaseCut = 1.0 / 24;  // h_5 + transition / 2 = 4 h_5 / 3
constexpr double kBaseSigma = kBaseCut / 3;

}  // namespace

double tracked_retinal_speed(double speed) { return speed - std::min(0.82 * speed + kDriftSpeed, kFastestTracked); }

double retinal_speed(double speed, Gaze gaze) {
  return std::max(gaze == Gaze::track ? std::abs(tracked_retinal_speed(speed)) : speed, kDriftSpeed);
}

double contrast_sensitivity(double frequency, double speed) {
  constexpr double c0 = 1.14, c1 = 0.67, c2 = 1.7;
  const double v = c2 * speed, w = 2 * kPi * c1 * frequency;
  const double log_speed = std::abs(std::log10(v / 3));
  return c0 * (6.1 + 7.3 * log_speed * log_speed * log_speed) * v * w * w * std::exp(-2 * w * (v + 2) / 45.9);
}

double static_contrast_sensitivity(double frequency, double luminance, double area, double distance) {
  const double peak = 0.801 * std::pow(1 + 0.7 / luminance, -0.2), decay = 0.3 * std::pow(1 + 100 / luminance, 0.15);
  const double accommodation = 0.856 * std::pow(distance, 0.14);
  const auto at = [&](double f) {
    if (!(f > 0)) return 0.0;
    const double size = std::pow(std::pow(3.23 * std::pow(f * f * area, -0.3), 5) + 1, -0.2), falls = decay * f;
    return size * peak * 0.9 * f * std::exp(-0.9 * falls) * std::sqrt(1 + 0.06 * std::exp(0.9 * falls));
  };
  return 250 * std::min(at(frequency / accommodation), at(frequency));
}

double highest_visible_frequency(double speed) {
  // Sensitivity has one peak and falls above it. Doubling finds an upper end of the interval, bisection the frequency.
  double low = 45.9 / (2 * kPi * 0.67 * (1.7 * speed + 2)), high = low;
  while (contrast_sensitivity(high, speed) > 1) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (contrast_sensitivity(middle, speed) > 1 ? low : high) = middle;
  }
  return low;
}

double slow_speed(double pixels_per_degree) {
  const double band = kUsefulBand * pixels_per_degree / 2;
  double low = kDriftSpeed, high = kFastestTracked;
  if (highest_visible_frequency(low) <= band) return low;
  if (highest_visible_frequency(high) > band) return high;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (highest_visible_frequency(middle) > band ? low : high) = middle;
  }
  return high;
}

double receptor_response(double luminance) {
  const double x = std::pow(luminance, 0.37);  // L / (L + 12.6 L^.63) in a form without 0 / 0
  return 100 * x / (x + 12.6);
}

double response_per_log_luminance(double response) { return 0.37 * response * (1 - response / 100); }

double mesa(double frequency, double h) {
  const double width = 2 * h / 3, into = frequency - h + width / 2;
  if (into <= 0) return 1;
  return into >= width ? 0 : 0.5 * (1 + std::cos(kPi * into / width));
}

double base_filter(double frequency) {
  return frequency < kBaseCut ? std::exp(-frequency * frequency / (2 * kBaseSigma * kBaseSigma)) : 0;
}

double band_filter(int band, double frequency) {
  if (band == kBaseBand) return base_filter(frequency);
  const double outer = mesa(frequency, inner(band - 1));
  return outer - (band == kBands - 1 ? base_filter(frequency) : mesa(frequency, inner(band)));
}

double band_frequency(int band) {
  if (band == kBaseBand) return std::numbers::sqrt2 * kBaseSigma;
  return std::min(4.0 / 3 * inner(band), 0.5);
}

double orientation_angle(int orientation) { return (30.0 * (orientation - 1) - 90) * kPi / 180; }

double fan_filter(double cosine) {
  const double square = cosine * cosine;  // cos 6d from cos d: Chebyshev's polynomial
  if (square <= 0.75) return 0;
  return 0.5 * (1 + ((32 * square - 48) * square + 18) * square - 1);
}

double masking_slope(int band) { return band == kBaseBand ? 0.7 : band >= 4 ? 0.8 : 1.0; }

double threshold_elevation(double contrast, double slope) {
  constexpr double W = 6, Q = 0.7, b = 4;
  static const double k1 = std::pow(W, 1 - 1 / (1 - Q)), k2 = std::pow(W, 1 / (1 - Q));
  return std::pow(1 + std::pow(k1 * std::pow(k2 * contrast, slope), b), 1 / b);
}

double detection_probability(double sum) { return -std::expm1(-sum); }

}  // namespace tempolux::vision
