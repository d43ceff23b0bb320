// lib/scene/environment.h -- light from infinitely far away: a latitude-longitude map, or one colour.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// Options of reading an environment.
struct EnvironmentOptions {
  double strength = 1;      ///< radiance [W/m^2/sr] of a pixel of value 1; >= 0
  double rotation_deg = 0;  ///< rotation of the map about world +Y, from +Z towards +X
  std::uint64_t max_pixels = 128ull << 20;
};

/// Radiance by direction, world space. The map is OpenEXR's latitude-longitude map (ImfEnvmap.h) in glTF's axes: the
/// top row is +Y; from left to right the map shows -Z, +X, +Z in the middle, -X and -Z again, as seen from inside. The
/// centre of pixel (x, y) of a map of w x h pixels lies at
///
///     longitude = pi - 2 pi (x + 1/2) / w,    latitude = pi/2 - pi (y + 1/2) / h,
///     direction = (sin(longitude + rotation) cos latitude, sin latitude, cos(longitude + rotation) cos latitude)
///
/// Between centres radiance is bilinear in longitude and latitude. Above the first row's centres it has the first row's
/// values, below the last row's centres the last row's. A map of one pixel is uniform.
struct Environment {
  std::string path;  ///< of the file, for messages; "" for a colour
  int width = 1, height = 1;
  std::vector<Rgb> radiance;  ///< by pixel, row 0 on top, W/m^2/sr, strength included; finite, >= 0
  double rotation_rad = 0;
  std::string hash;                   ///< of pixels, strength and rotation
  std::vector<std::string> warnings;  ///< repairs, one line each

  /// True if some pixel is not black.
  bool emits() const;
};

/// Reads a map: Radiance HDR, OpenEXR, or any other format of load_by_module() (8 bits cannot hold a sun). Negative
/// values, which resampling may create, become 0 with a warning. Throws InputError for a file without R, G and B, for
/// NaN, infinity, more than max_pixels, or radiance above 1e30.
Environment load_environment(const std::string& path, const EnvironmentOptions& options);
/// An environment of the same radiance in all directions. Throws InputError as above; the rotation has no effect.
Environment uniform_environment(Rgb color, const EnvironmentOptions& options);

}  // namespace tempolux
