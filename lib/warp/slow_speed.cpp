#include "lib/warp/slow_speed.h"

#include <cmath>
#include <numbers>

namespace tempolux {
namespace {

constexpr double kDrift = 0.15;      // degrees/s: drift of a resting eye over the picture
constexpr double kUsefulBand = 0.9;  // share of the display's highest frequency
constexpr double kFastest = 80;      // degrees/s: faster patterns are not followed and hardly visible

double sensitivity(double frequency, double speed) {
  constexpr double c0 = 1.14, c1 = 0.67, c2 = 1.7;
  const double v = c2 * speed, w = 2 * std::numbers::pi * c1 * frequency, l = std::abs(std::log10(v / 3));
  return c0 * (6.1 + 7.3 * l * l * l) * v * w * w * std::exp(-2 * w * (v + 2) / 45.9);
}

}  // namespace

double highest_visible_frequency(double retinal_speed) {
  // Sensitivity falls above its peak, so it is below 1 at some multiple of the peak's frequency. Doubling finds an
  // upper end of the interval, bisection the frequency.
  double low = 45.9 / (2 * std::numbers::pi * 0.67 * (1.7 * retinal_speed + 2)), high = low;
  while (sensitivity(high, retinal_speed) > 1) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (sensitivity(middle, retinal_speed) > 1 ? low : high) = middle;
  }
  return low;
}

double slow_speed(double pixels_per_degree) {
  const double band = kUsefulBand * pixels_per_degree / 2;
  // For an eye that does not follow, the speed over the retina is the pattern's speed
  double low = kDrift, high = kFastest;
  if (highest_visible_frequency(low) <= band) return kDrift;
  if (highest_visible_frequency(high) > band) return kFastest;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (highest_visible_frequency(middle) > band ? low : high) = middle;
  }
  return high;
}

}  // namespace tempolux
