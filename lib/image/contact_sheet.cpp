#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "lib/image/preview.h"
#include "lib/image/srgb.h"

namespace tempolux {
namespace {

constexpr int kGap = 2;

/// Averages linear light over the area of each target pixel. A source pixel counts by the share of it that the target
/// pixel covers.
Picture shrink(const Picture& from, int width, int height) {
  std::array<float, 256> linear;
  for (std::size_t code = 0; code < linear.size(); ++code) linear[code] = srgb_to_linear(float(code) / 255);

  Picture to{width, height, std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height) * 3)};
  const double step_x = double(from.width) / width, step_y = double(from.height) / height;
  const auto overlap = [](int cell, double first, double last) {
    return std::min(double(cell) + 1, last) - std::max(double(cell), first);
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double x0 = x * step_x, x1 = std::min((x + 1) * step_x, double(from.width));
      const double y0 = y * step_y, y1 = std::min((y + 1) * step_y, double(from.height));
      std::array<double, 3> sum{};
      for (int j = int(y0); j < y1; ++j)
        for (int i = int(x0); i < x1; ++i) {
          const double weight = overlap(i, x0, x1) * overlap(j, y0, y1);
          const std::size_t at = 3 * (std::size_t(j) * std::size_t(from.width) + std::size_t(i));
          for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * double(linear[from.rgb[at + c]]);
        }
      const std::size_t at = 3 * (std::size_t(y) * std::size_t(width) + std::size_t(x));
      for (std::size_t c = 0; c < 3; ++c)
        to.rgb[at + c] = std::uint8_t(std::lround(255 * linear_to_srgb(float(sum[c] / ((x1 - x0) * (y1 - y0))))));
    }
  }
  return to;
}

Picture fitted(const Picture& picture, int max_width) {
  if (picture.width <= max_width) return picture;
  const auto height = std::max(1l, std::lround(double(picture.height) * max_width / picture.width));
  return shrink(picture, max_width, int(height));
}

}  // namespace

void mark(Picture& picture) {
  constexpr std::array<std::uint8_t, 3> kAmber{255, 176, 0};
  const int border = std::max(2, picture.width / 40);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (std::min({x, y, picture.width - 1 - x, picture.height - 1 - y}) < border)
        std::copy(kAmber.begin(), kAmber.end(), picture.rgb.begin() + 3 * (std::ptrdiff_t(y) * picture.width + x));
}

Picture contact_sheet(const std::vector<Picture>& pictures, int columns, int max_width) {
  if (pictures.empty() || columns < 0 || max_width < 1)
    throw std::invalid_argument("contact_sheet: no pictures, or columns or width out of range");
  int cell_width = 0, cell_height = 0;
  std::vector<Picture> small;
  for (const Picture& picture : pictures) {
    if (picture.width < 1 || picture.height < 1) throw std::invalid_argument("contact_sheet: an empty picture");
    small.push_back(fitted(picture, max_width));
    cell_width = std::max(cell_width, small.back().width);
    cell_height = std::max(cell_height, small.back().height);
  }
  const int count = int(pictures.size());
  const int wide = columns > 0 ? std::min(columns, count) : int(std::ceil(std::sqrt(double(count))));
  const int high = (count + wide - 1) / wide;

  Picture sheet;
  sheet.width = wide * cell_width + (wide - 1) * kGap;
  sheet.height = high * cell_height + (high - 1) * kGap;
  sheet.rgb.resize(std::size_t(sheet.width) * std::size_t(sheet.height) * 3);
  for (int index = 0; index < count; ++index) {
    const Picture& picture = small[std::size_t(index)];
    const int left = index % wide * (cell_width + kGap), top = index / wide * (cell_height + kGap);
    for (int y = 0; y < picture.height; ++y)
      std::copy_n(picture.rgb.begin() + std::ptrdiff_t(y) * picture.width * 3, picture.width * 3,
                  sheet.rgb.begin() + (std::ptrdiff_t(top + y) * sheet.width + left) * 3);
  }
  return sheet;
}

}  // namespace tempolux
