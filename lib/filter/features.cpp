#include "lib/filter/features.h"

#include <cmath>
#include <string>
#include <vector>

#include "lib/filter/picture.h"
#include "lib/filter/rows.h"

namespace tempolux {
namespace {

constexpr std::array<const char*, Features::kCount> kNames{"N.X",      "N.Y",      "N.Z",     "inverse_Z",
                                                           "albedo.R", "albedo.G", "albedo.B"};

std::string mean_name(const std::string& name) { return "coverage.mean." + name; }
std::string error_name(const std::string& name) { return "coverage.error." + name; }

}  // namespace

Features::Features(const Image& image) {
  for (const char* name : kNames)
    if (!holds(image, mean_name(name))) return;
  const auto finite = [](float v) { return std::abs(v) < 1e9f ? v : 0; };
  const auto for_each_pixel = [&](const auto& body) {
    for_each_row(image.height, [&](int y) {
      for (int x = 0; x < image.width; ++x) body(x, y, std::size_t(y) * std::size_t(image.width) + std::size_t(x));
    });
  };
  Plane everywhere = Plane::unset(image.width, image.height);
  for_each_pixel([&](int x, int y, std::size_t) { everywhere.at(x, y) = 1; });
  for (std::size_t f = 0; f < kCount; ++f) {
    mean[f] = Plane::unset(image.width, image.height);
    variance[f] = Plane(image.width, image.height);
    const std::vector<float>& means = image.find(mean_name(kNames[f]))->values;
    for_each_pixel([&](int x, int y, std::size_t p) { mean[f].at(x, y) = finite(means[p]); });
    if (!holds(image, error_name(kNames[f]))) continue;
    const std::vector<float>& errors = image.find(error_name(kNames[f]))->values;
    Plane squares = Plane::unset(image.width, image.height);
    for_each_pixel([&](int x, int y, std::size_t p) { squares.at(x, y) = finite(errors[p]) * finite(errors[p]); });
    for_each_pixel([&](int x, int y, std::size_t) { variance[f].at(x, y) = mean_of_nine(squares, everywhere, x, y); });
  }
}

}  // namespace tempolux
