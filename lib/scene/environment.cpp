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

/// Multiplies values by the strength; counts negative values and sets them to 0.
class Scale {
 public:
  Scale(const Environment& environment, double strength) : environment_(environment), strength_(strength) {}

  float operator()(float value, std::size_t pixel) {
    if (value < 0 && negative_++ == 0) first_negative_ = pixel;
    const double radiance = std::max(0.0, double(value) * strength_);
    if (!(radiance <= kMostRadiance))
      throw InputError(environment_.path + ": " + pixel_name(pixel, environment_.width) +
                       ": its radiance is beyond 1e30; lower --environment-strength");
    return float(radiance);
  }
  void warn(std::vector<std::string>& warnings) const {
    if (negative_ > 0)
      warnings.push_back(environment_.path + ": " + std::to_string(negative_) + " negative values, the first at " +
                         pixel_name(first_negative_, environment_.width) + ", are taken as 0");
  }

 private:
  const Environment& environment_;
  double strength_;
  std::uint64_t negative_ = 0;
  std::size_t first_negative_ = 0;
};

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
  Scale scale(environment, options.strength);
  for (std::size_t i = 0; i < environment.radiance.size(); ++i)
    environment.radiance[i] = {scale(image.pixels[i].r, i), scale(image.pixels[i].g, i), scale(image.pixels[i].b, i)};
  scale.warn(environment.warnings);
  environment.hash = content_hash(environment);
  return environment;
}

Environment uniform_environment(Rgb color, const EnvironmentOptions& options) {
  Environment environment;
  environment.path = "--environment";
  Scale scale(environment, options.strength);
  if (!is_finite(color) || std::min({color.r, color.g, color.b}) < 0)
    throw InputError("--environment: a colour is three numbers from 0 on, as 0.2,0.3,0.5");
  environment.radiance = {{scale(color.r, 0), scale(color.g, 0), scale(color.b, 0)}};
  environment.hash = content_hash(environment);
  return environment;
}

}  // namespace tempolux
