#include "lib/image/srgb.h"

#include <algorithm>
#include <cmath>

namespace tempolux {

float srgb_to_linear(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float linear_to_srgb(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 1;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

double srgb_code(double value) {
  const double v = std::clamp(value, 0.0, 1.0);
  return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
}

double exposure_of(std::vector<double> means) {
  const auto median = [&] {
    const auto middle = means.begin() + std::ptrdiff_t(means.size() / 2);
    std::nth_element(means.begin(), middle, means.end());
    return *middle;
  };
  if (!means.empty() && !(median() > 0)) std::erase_if(means, [](double mean) { return !(mean > 0); });
  return means.empty() ? 1 : 0.18 / median();
}

}  // namespace tempolux
