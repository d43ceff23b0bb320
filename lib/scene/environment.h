// lib/scene/environment.h -- light from infinitely far: a latitude-longitude map, or one colour all around.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// How an environment is to be read.
struct EnvironmentOptions {
  double strength = 1;      ///< radiance [W/m^2/sr] of a pixel of value 1; >= 0
  double rotation_deg = 0;  ///< of the map about world +Y, from +Z towards +X
  std::uint64_t max_pixels = 128ull << 20;
};

/// Radiance by direction, world space. OpenEXR's latitude-longitude map (ImfEnvmap.h) about glTF's axes: the top row is
/// +Y; from left to right the map shows -Z, +X, +Z (its middle), -X and -Z again, as seen from inside. Pixel (x, y) of
/// a map of w x h pixels has its centre at longitude pi - 2 pi (x + 1/2) / w and latitude pi/2 - pi (y + 1/2) / h,
///
///     direction = (sin(longitude + rotation) cos latitude, sin latitude, cos(longitude + rotation) cos latitude)
///
/// Between centres radiance is linear in both; above the first and below the last row it is that row's. One pixel is
/// the same all around.
struct Environment {
  std::string path;  ///< of the file; "" for a colour. For messages
  int width = 1, height = 1;
  std::vector<Rgb> radiance;  ///< by pixel, row 0 on top, W/m^2/sr, strength included; finite, >= 0
  double rotation_rad = 0;
  std::string hash;                   ///< of all of it: pixels, strength, rotation
  std::vector<std::string> warnings;  ///< what was mended, one line each

  bool emits() const;  ///< some pixel is not black
};

/// Reads a map: Radiance HDR or OpenEXR, or whatever else load_image reads (8 bits cannot hold a sun). Negative
/// values, which resampling leaves behind, become 0 with a warning. Throws InputError for a file without R, G and B,
/// NaN, infinity, more than max_pixels, or radiance beyond 1e30.
Environment load_environment(const std::string& path, const EnvironmentOptions& options);
/// The same radiance from everywhere. Throws InputError as above; the rotation does not matter.
Environment uniform_environment(Rgb color, const EnvironmentOptions& options);

}  // namespace tempolux
