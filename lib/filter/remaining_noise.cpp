#include "lib/filter/remaining_noise.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lib/filter/picture.h"
#include "lib/image/srgb.h"

namespace tempolux {
namespace {

constexpr int kBlock = 32;  ///< pixels: edge of the blocks from which the standard error is estimated
const std::string kNoise = "tempolux:noise.";

double exposure_of(const std::array<const std::vector<float>*, 3>& picture) {
  std::vector<double> means(picture[0]->size());
  for (std::size_t p = 0; p < means.size(); ++p)
    means[p] = double(((*picture[0])[p] + (*picture[1])[p] + (*picture[2])[p]) / 3);
  return tempolux::exposure_of(std::move(means));
}

constexpr double kWhite = 255;

/// Squared error in codes over the squared linear error e^2 (`square`) at an exposed value, mean over both signs of e.
/// For small errors the ratio is the squared slope of the display curve. The ratio times e^2 is at most 255^2.
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

/// Squared errors in one unit.
struct Errors {
  std::string name;
  double most;         ///< largest possible error
  double unknown = 0;  ///< lower bound of the raw frame's measured noise
  Mean whole, noise, known;

  Errors(const char* unit, double most_possible, const Image& frame) : name(kNoise + unit), most(most_possible) {
    const auto said = frame.numbers.find(name), error = frame.numbers.find(name + "_error");
    if (said != frame.numbers.end() && error != frame.numbers.end())
      unknown = std::max(0.0, said->second - error->second);
  }
  void write(Image& frame) const {
    const double missed = std::max(0.0, unknown * unknown - known.value());
    const double square = std::max({whole.value(), noise.value(), 0.0}) + missed,
                 root = std::min(most, std::sqrt(square)), error = whole.error();
    frame.numbers[name] = root;
    frame.numbers[name + "_error"] = root * root > error ? error / (2 * root) : std::sqrt(error);
  }
};

/// Adds the block whose first pixel is (left, top).
void add_block(const RemainingError& error, const Image& frame, int left, int top, double exposure, Errors& linear,
               Errors& codes) {
  const auto picture = frame.rgb("");
  std::array<double, 3> sums{}, in_codes{};
  double count = 0;
  for (int y = top; y < std::min(frame.height, top + kBlock); ++y)
    for (int x = left; x < std::min(frame.width, left + kBlock); ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t p = std::size_t(y) * std::size_t(frame.width) + std::size_t(x);
        const std::array<float, 3> squares{error.whole[c][p], error.noise[c][p], error.known[c][p]};
        if (!std::ranges::all_of(squares, [](float v) { return std::isfinite(v); })) continue;
        const double exposed2 = exposure * exposure, largest = std::max({squares[0], squares[1], squares[2]}),
                     factor = exposed2 * codes_for_square(exposure * double((*picture[c])[p]), exposed2 * largest);
        for (std::size_t i = 0; i < squares.size(); ++i)
          sums[i] += double(squares[i]), in_codes[i] += factor * double(squares[i]);
        ++count;
      }
  const auto add = [&](const std::array<double, 3>& to_add, Errors& errors) {
    errors.whole.add(to_add[0], count), errors.noise.add(to_add[1], count), errors.known.add(to_add[2], count);
  };
  add(sums, linear);
  add(in_codes, codes);
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
  RemainingError error{change_, filtered_, raw_};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t p = 0; p < change_[c].size(); ++p) {
      const float n = raw_[c][p], k = filtered_[c][p], off = change_[c][p];
      error.whole[c][p] = off * off + n * (2 * k - n);
      error.noise[c][p] = k * k;
      error.known[c][p] = n * n;
    }
  return error;
}

void write_remaining_noise(const RemainingError& error, Image& frame) {
  Errors linear("linear", HUGE_VAL, frame), codes("codes", kWhite, frame);
  std::erase_if(frame.numbers, [](const auto& number) { return number.first.starts_with(kNoise); });
  if (error.whole[0].empty() || !holds(frame, "R") || !holds(frame, "G") || !holds(frame, "B")) return;
  const double exposure = exposure_of(frame.rgb(""));
  for (int top = 0; top < frame.height; top += kBlock)
    for (int left = 0; left < frame.width; left += kBlock) add_block(error, frame, left, top, exposure, linear, codes);
  linear.write(frame);
  codes.write(frame);
  frame.numbers[kNoise + "exposure"] = exposure;
}

}  // namespace tempolux
