// lib/aqm/difference.cpp -- stores signed differences as channels and as colours.
#include "lib/aqm/difference.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

/// Mean of x - r over the channels; 0 where the pixel does not count.
double mean_difference(const Compared& pair, std::size_t i) {
  if (!pair.counts(i)) return 0;
  double sum = 0;
  for (std::size_t c = 0; c < pair.test.size(); ++c) sum += double((*pair.test[c])[i]) - pair.reference_at(c, i);
  return sum / double(pair.test.size());
}

}  // namespace

Image difference_image(const Compared& pair) {
  Image image;
  image.width = pair.width;
  image.height = pair.height;
  for (std::size_t c = 0; c < pair.test.size(); ++c) {
    Channel& channel = image.add(pair.channels[c].empty() ? "Y" : pair.channels[c]);
    for (std::size_t i = 0; i < channel.values.size(); ++i)
      if (pair.counts(i)) channel.values[i] = float(double((*pair.test[c])[i]) - pair.reference_at(c, i));
  }
  return image;
}

double difference_scale(const Compared& pair) {
  std::vector<double> sizes;
  for (std::size_t i = 0; i < pair.test[0]->size(); ++i)
    if (pair.counts(i)) sizes.push_back(std::abs(mean_difference(pair, i)));
  const auto rank = sizes.begin() + std::ptrdiff_t(0.99 * double(sizes.size() - 1));
  std::nth_element(sizes.begin(), rank, sizes.end());
  const double wanted = *rank > 0 ? *rank : *std::ranges::max_element(sizes);
  if (wanted <= 0) return 1;
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= wanted) return step * decade;
  return 10 * decade;
}

Picture difference_picture(const Compared& pair, double scale) {
  Picture picture{pair.width, pair.height, {}};
  picture.rgb.reserve(pair.test[0]->size() * 3);
  constexpr double kGrey = 128;
  for (std::size_t i = 0; i < pair.test[0]->size(); ++i) {
    const double t = std::clamp(mean_difference(pair, i) / scale, -1.0, 1.0);
    const double towards = kGrey + (255 - kGrey) * std::abs(t), away = kGrey * (1 - std::abs(t));
    const auto byte = [](double v) { return std::uint8_t(std::lround(v)); };
    picture.rgb.push_back(byte(t > 0 ? towards : away));
    picture.rgb.push_back(byte(away));
    picture.rgb.push_back(byte(t < 0 ? towards : away));
  }
  return picture;
}

}  // namespace tempolux
