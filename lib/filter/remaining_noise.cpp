#include "lib/filter/remaining_noise.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lib/core/random.h"
#include "lib/filter/picture.h"
#include "lib/image/srgb.h"

namespace tempolux {
namespace {

constexpr int kBlock = 32;  ///< pixels: edge of the blocks from which the standard error is estimated
const std::string kNoise = "tempolux:noise.";

double exposure_of(const PicturePlanes& picture) {
  std::vector<double> means(picture[0]->size());
  for (std::size_t p = 0; p < means.size(); ++p)
    means[p] = double(((*picture[0])[p] + (*picture[1])[p] + (*picture[2])[p]) / 3);
  return tempolux::exposure_of(std::move(means));
}

/// Converts a squared error: returns the squared error in codes divided by the squared linear error e^2 = `square`, for
/// a pixel of this exposed value. The squared error in codes is the mean of the squared differences in codes of value +
/// e and of value - e from value. For a small e the result is the squared slope of the sRGB curve.
double codes_for_square(double value, double square) {
  if (!(square > 0)) return 0;
  const double e = std::sqrt(square), code = srgb_code(value);
  const double above = srgb_code(value + e) - code, below = code - srgb_code(value - e);
  return (above * above + below * below) / (2 * square);
}

/// Mean of squared errors over pixels, and its standard error from blocks of pixels.
class Mean {
 public:
  void add(double sum, double count) {
    sum_ += sum, count_ += count;
    squares_ += sum * sum, products_ += sum * count, counts_ += count * count;
  }
  double value() const { return count_ > 0 ? sum_ / count_ : 0; }
  double error() const {
    if (!(count_ > 0)) return 0;
    const double mean = value();
    return std::sqrt(std::max(0.0, squares_ - 2 * mean * products_ + mean * mean * counts_)) / count_;
  }

 private:
  double sum_ = 0, count_ = 0, squares_ = 0, products_ = 0, counts_ = 0;
};

void write_root(const std::string& name, const Mean& whole, const Mean& noise, Image& frame) {
  const Mean& larger = whole.value() > noise.value() ? whole : noise;
  const double root = std::sqrt(std::max(0.0, larger.value())), error = larger.error();
  frame.numbers[name] = root;
  frame.numbers[name + "_error"] = root * root > error ? error / (2 * root) : std::sqrt(error);
}

/// Squared errors of the picture or of a layer.
struct Errors {
  Mean whole, noise, whole_codes, noise_codes;
  void write(const std::string& name, Image& frame) const {
    write_root(name + "linear", whole, noise, frame);
    write_root(name + "codes", whole_codes, noise_codes, frame);
  }
};

constexpr double kEnough = 1 << 17;  ///< pixels whose codes are converted; all pixels of a large picture cost too much

/// Sums over the blocks of a picture or layer. square_of(c, p) returns `whole` and the squared noise of a pixel. If the
/// picture has many more than kEnough pixels, a random share of them is summed.
template <class Square>
Errors sum_blocks(const Image& frame, const PicturePlanes& picture, double exposure, const Square& square_of) {
  Errors errors;
  const auto step = std::uint64_t(std::max(1.0, std::round(std::sqrt(double(frame.pixel_count()) / kEnough))));
  for (int top = 0; top < frame.height; top += kBlock)
    for (int left = 0; left < frame.width; left += kBlock) {
      double count = 0, whole = 0, noise = 0, whole_codes = 0, noise_codes = 0;
      for (int y = top; y < std::min(frame.height, top + kBlock); ++y)
        for (int x = left; x < std::min(frame.width, left + kBlock); ++x) {
          const std::size_t p = std::size_t(y) * std::size_t(frame.width) + std::size_t(x);
          if ((mix64(p) >> 32) * step * step >> 32 != 0) continue;
          for (std::size_t c = 0; c < 3; ++c) {
            const auto [of_whole, of_noise] = square_of(c, p);
            if (!std::isfinite(of_whole) || !std::isfinite(of_noise)) continue;
            const double value = exposure * double((*picture[c])[p]), square = exposure * exposure * of_whole;
            whole += of_whole;
            noise += of_noise;
            whole_codes += square * codes_for_square(value, std::abs(square));
            const double off = srgb_code(value) - srgb_code(value - exposure * std::sqrt(of_noise));
            noise_codes += off * off;
            ++count;
          }
        }
      errors.whole.add(whole, count), errors.noise.add(noise, count);
      errors.whole_codes.add(whole_codes, count), errors.noise_codes.add(noise_codes, count);
    }
  return errors;
}

}  // namespace

void RemainingNoise::add(const Halves& raw, const Halves& filtered) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (Colours* sums : {&raw_, &filtered_, &change_}) (*sums)[c].resize(raw.a[c].size());
    for (std::size_t p = 0; p < raw.a[c].size(); ++p) {
      const float a = raw.a[c][p], b = raw.b[c][p], f = filtered.a[c][p], g = filtered.b[c][p];
      raw_[c][p] += (a - b) / 2;
      filtered_[c][p] += (f - g) / 2;
      change_[c][p] += mean_of(f, g) - mean_of(a, b);
    }
  }
}

RemainingError RemainingNoise::error() const {
  RemainingError error{change_, filtered_};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t p = 0; p < change_[c].size(); ++p) {
      const float n = raw_[c][p], k = filtered_[c][p], off = change_[c][p];
      error.whole[c][p] = off * off + n * (2 * k - n);
      error.noise[c][p] = k * k;
    }
  return error;
}

void write_remaining_noise(const RemainingError& error, Image& frame) {
  std::erase_if(frame.numbers, [](const auto& number) { return number.first.starts_with(kNoise); });
  if (error.whole[0].empty() || !has_colour(frame, "")) return;
  const double exposure = exposure_of(frame.rgb(""));
  sum_blocks(frame, frame.rgb(""), exposure, [&](std::size_t c, std::size_t p) {
    return std::pair(double(error.whole[c][p]), double(error.noise[c][p]));
  }).write(kNoise, frame);
  for (const std::string layer : kFrameLayers) {
    if (!holds(frame, layer + ".R") || !holds(frame, layer + ".noise.R")) continue;
    const auto noise = frame.rgb(layer + ".noise");
    const Errors errors = sum_blocks(frame, frame.rgb(layer), exposure, [&](std::size_t c, std::size_t p) {
      return std::pair(0.0, double((*noise[c])[p]) * double((*noise[c])[p]));
    });
    if (errors.noise.value() > 0) errors.write(kNoise + layer + ".", frame);
  }
  frame.numbers[kNoise + "exposure"] = exposure;
}

}  // namespace tempolux
