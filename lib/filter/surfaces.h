// lib/filter/surfaces.h -- what the pixels of a frame see, as the filter asks for it: may two of them share light?
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "lib/filter/plane.h"
#include "lib/image/image.h"
#include "lib/image/pixel_surfaces.h"

namespace tempolux {

/// A coloured plane.
using ColourPlane = std::array<Plane, 3>;

/// Larger values of light are left as they are: squares stay finite.
inline constexpr float kLargestLight = 1e18f;

struct Surfaces {
  int width = 0, height = 0;
  PlaneT<std::uint32_t> object;
  Plane w, w_right, w_down, nx, ny, nz;  ///< PixelSurfaces
  ColourPlane albedo;                    ///< what radiance is divided by, at least .01; empty planes: nothing
  Plane use;     ///< 1: the pixel sees one surface and holds numbers; 0: no other may take light from it
  Plane inside;  ///< 1: of use, and the pixels around are on the same surface

  /// Of the first surfaces, or of what mirrors and glass show: seen, where the image has the channels seen.*
  /// (formats/frames/frames.md).
  Surfaces(const Image& image, bool seen);

  /// Is the pixel (dx, dy) from (x, y) on its surface, as PixelSurfaces::same says, whether it is of use or not?
  bool on_surface(int x, int y, int dx, int dy) const;
  bool has_pixel(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  float albedo_at(std::size_t c, int x, int y) const { return albedo[c].empty() ? 1 : albedo[c].at(x, y); }

 private:
  void take_depth(const Channel* z);
  void take_albedo(const Image& image, const std::string& name);
  void take_edges(const Image& image);
};

}  // namespace tempolux
