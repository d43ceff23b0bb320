#include "lib/filter/features.h"

#include <algorithm>
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
  for (std::size_t f = 0; f < kCount; ++f) {
    const auto finite = [](float v) { return std::abs(v) < 1e9f ? v : 0; };
    mean[f] = Plane::unset(image.width, image.height);
    variance[f] = Plane(image.width, image.height);
    const std::vector<float>& means = image.find(mean_name(kNames[f]))->values;
    std::vector<float> squares(means.size());
    if (holds(image, error_name(kNames[f]))) {
      const std::vector<float>& errors = image.find(error_name(kNames[f]))->values;
      std::transform(errors.begin(), errors.end(), squares.begin(), [&](float e) { return finite(e) * finite(e); });
    }
    for_each_row(image.height, [&](int y) {
      for (int x = 0; x < image.width; ++x) {
        mean[f].at(x, y) = finite(means[std::size_t(y) * std::size_t(image.width) + std::size_t(x)]);
        float sum = 0, count = 0;
        for (int j = std::max(0, y - 1); j <= std::min(image.height - 1, y + 1); ++j)
          for (int i = std::max(0, x - 1); i <= std::min(image.width - 1, x + 1); ++i) {
            sum += squares[std::size_t(j) * std::size_t(image.width) + std::size_t(i)];
            count += 1;
          }
        variance[f].at(x, y) = sum / count;
      }
    });
  }
}

}  // namespace tempolux
