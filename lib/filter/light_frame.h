// lib/filter/light_frame.h -- a frame as the filter sees it: light without texture, how noisy it is, what its pixels see.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/filter/plane.h"
#include "lib/image/image.h"
#include "lib/image/pixel_surfaces.h"

namespace tempolux {

/// What is known of the noise of a frame.
enum class NoiseKnowledge {
  none,       ///< nothing: neither variance nor samples; the filter takes plain weights
  estimated,  ///< some pixels have one sample: noise is told from what neighbours on one surface differ by
  told        ///< by the variance channels
};

/// Larger values of light are left as they are: squares stay finite.
inline constexpr float kLargestLight = 1e18f;

/// Does the filter read a channel of this name of the frame that it filters; of those around it?
bool is_read_to_filter(const std::string& channel);
bool is_read_by_others(const std::string& channel);

/// A coloured plane.
using ColourPlane = std::array<Plane, 3>;

/// The layers st-filter filters; emission and specular pass by.
inline constexpr std::array<const char*, 3> kFilteredLayers{"direct", "caustic", "indirect"};

/// Light is radiance over albedo where the frame has albedo, so that textures are left out.
struct LightFrame {
  int width = 0, height = 0;
  NoiseKnowledge noise = NoiseKnowledge::none;
  std::vector<std::string> layers;     ///< that are filtered: "direct", "caustic", "indirect" as far as present; else "" alone, R G B
  std::vector<ColourPlane> light;      ///< by layer; empty planes: black everywhere
  ColourPlane albedo;                  ///< what radiance was divided by; empty planes: nothing
  PlaneT<std::uint32_t> object;
  Plane w, w_right, w_down, nx, ny, nz;   ///< PixelSurfaces
  Plane use;                           ///< 1: the pixel sees one surface and holds numbers; 0: no other may take light from it
  Plane inside;                        ///< 1: of use, and the pixels around are on the same surface
  Plane variance;                      ///< of the sum of the layers, one pixel's, summed over channels; smoothed
  ColourPlane mean;                    ///< of the sum of the layers over a small window on the surface: what values are compared by
  Plane mean_variance;                 ///< of that, summed over channels

  /// Where `use` is 0 mean and variances are those of the surface at the pixel's centre, from its other pixels. Pixels that are
  /// not finite are left out like edges.
  explicit LightFrame(const Image& image, std::span<const char* const> wanted = kFilteredLayers);
  /// The same, of an image that is not needed any more: what was taken of its samples is freed, its channels are there without.
  explicit LightFrame(Image&& image, std::span<const char* const> wanted = kFilteredLayers);

  /// Is the pixel (dx, dy) from (x, y) on its surface, as PixelSurfaces::same says, whether it is of use or not?
  bool on_surface(int x, int y, int dx, int dy) const;
  bool has_pixel(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};

}  // namespace tempolux
