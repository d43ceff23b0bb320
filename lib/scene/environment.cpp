// lib/scene/environment.cpp -- reads environment maps.
#include "lib/scene/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/image/image.h"
#include "lib/image/images_by_module.h"

namespace tempolux {
namespace {

/// Largest radiance of a map, W/m^2/sr. Products of radiance, solid angle, area and 1 / probability then stay below the
/// largest number of float32, 3.4e38.
constexpr double kMostRadiance = 1e30;

std::string content_hash(const Environment& environment) {
  static_assert(sizeof(Rgb) == 12);
  Hasher hasher;
  hasher.add(std::string_view("environment 1"));
  hasher.add(std::uint32_t(environment.width));
  hasher.add(std::uint32_t(environment.height));
  hasher.add_array(std::span<const Rgb>(environment.radiance));
  hasher.add(environment.rotation_rad);
  return hasher.hex();
}

/// The radiance of a value; 0 for a negative value. Throws InputError if it is above kMostRadiance.
float radiance_of(const Environment& environment, float value, double strength, std::size_t pixel) {
  const double radiance = std::max(0.0, double(value) * strength);
  if (!(radiance <= kMostRadiance))
    throw InputError(environment.path + ": " + pixel_name(pixel, environment.width) +
                     ": its radiance is beyond 1e30; lower --environment-strength");
  return float(radiance);
}

}  // namespace

bool Environment::emits() const {
  return std::ranges::any_of(radiance, [](const Rgb& pixel) { return max_component(pixel) > 0; });
}

Environment load_environment(const std::string& path, const EnvironmentOptions& options) {
  const LinearPixels image = load_by_module(path, options.max_pixels);
  Environment environment;
  environment.path = path;
  environment.width = image.width;
  environment.height = image.height;
  // Removes full turns from the rotation, so that equal light has an equal hash.
  environment.rotation_rad = std::remainder(options.rotation_deg, 360.0) * std::numbers::pi / 180;
  environment.radiance.resize(image.pixels.size());
  std::size_t negative = 0, first_negative = 0;
  for (std::size_t i = 0; i < environment.radiance.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      if (image.pixels[i][c] < 0 && negative++ == 0) first_negative = i;
      environment.radiance[i][c] = radiance_of(environment, image.pixels[i][c], options.strength, i);
    }
  if (negative > 0)
    environment.warnings.push_back(path + ": " + std::to_string(negative) + " negative values, the first at " +
                                   pixel_name(first_negative, environment.width) + ", are taken as 0");
  environment.hash = content_hash(environment);
  return environment;
}

Environment uniform_environment(Rgb color, const EnvironmentOptions& options) {
  Environment environment;
  environment.path = "--environment";
  if (!is_finite(color) || std::min({color.r, color.g, color.b}) < 0)
    throw InputError("--environment: a colour is three numbers from 0 on, as 0.2,0.3,0.5");
  for (int c = 0; c < 3; ++c) color[c] = radiance_of(environment, color[c], options.strength, 0);
  environment.radiance = {color};
  environment.hash = content_hash(environment);
  return environment;
}

}  // namespace tempolux
