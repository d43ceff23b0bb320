// lib/aqm/display.cpp -- displays and their luminance.
#include "lib/aqm/display.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "formats/error.h"
#include "lib/core/parallel_each.h"

namespace tempolux::vision {
namespace {

/// Pixels per degree at the centre of a 16:9 display.
double pixels_per_degree(double columns, double diagonal_inches, double distance_m) {
  const double width_m = diagonal_inches * 0.0254 * 16 / std::hypot(16.0, 9.0);
  return 2 * std::tan(0.5 * std::numbers::pi / 180) * distance_m * columns / width_m;
}

/// Luminance of black: the display's own, and half a percent of the room's light.
double black_level(double peak, double contrast, double room_lux) {
  return peak / contrast + 0.005 * room_lux / std::numbers::pi;
}

}  // namespace

std::span<const Display> displays() {
  static const std::array<Display, 3> all{
      Display{"office", 200, 200, black_level(200, 1000, 250), pixels_per_degree(1920, 24, 0.6), 0.6},
      Display{"hdr", 203, 1500, black_level(1500, 1e6, 10), pixels_per_degree(3840, 30, 0.7472), 0.7472},
      Display{"dark", 200, 200, black_level(200, 1000, 0), pixels_per_degree(1920, 24, 0.6), 0.6}};
  return all;
}

Display display_named(const std::string& name) {
  std::string names;
  for (const Display& display : displays()) {
    if (display.name == name) return display;
    names += (names.empty() ? "" : ", ") + display.name;
  }
  throw InputError("--display " + name + ": unknown; there are: " + names);
}

std::vector<float> displayed_luminance(const Display& display, const std::vector<const std::vector<float>*>& planes,
                                       double exposure) {
  constexpr std::array<double, 3> kRec709{0.2126, 0.7152, 0.0722};
  constexpr std::array<double, 3> kGrey{1, 0, 0};
  const auto& weight = planes.size() == 3 ? kRec709 : kGrey;
  const double range = display.white - display.black, largest = (display.peak - display.black) / range;
  std::vector<float> luminance(planes.at(0)->size());
  parallel_each(luminance.size(), 1 << 16, [&](std::size_t i) {
    double sum = 0;
    for (std::size_t c = 0; c < planes.size(); ++c) {
      const double value = double((*planes[c])[i]) * exposure;
      sum += weight[c] * (value > 0 ? std::min(value, largest) : 0);  // NaN counts as 0
    }
    luminance[i] = float(display.black + range * sum);
  });
  return luminance;
}

}  // namespace tempolux::vision
