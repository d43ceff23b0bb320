// lib/filter/surfaces.h -- the surfaces that the pixels of a frame see: may two pixels share light?
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

/// Values of light above this stay unfiltered, so that squares are finite.
inline constexpr float kLargestLight = 1e18f;

/// The surface of each pixel of a frame.
struct Surfaces {
  int width = 0, height = 0;
  PlaneT<std::uint32_t> object;
  Plane w, w_right, w_down, nx, ny, nz;  ///< PixelSurfaces
  ColourPlane albedo;                    ///< divides radiance, at least .01; empty planes: 1
  Plane use;     ///< 1: the pixel sees one surface and its values are finite; 0: no other pixel may use its light
  Plane inside;  ///< 1: the pixel has `use`, and all neighbours are on its surface

  /// The first surface on each pixel's ray. With `seen`: the surfaces that mirrors and glass show, if the image has the
  /// channels seen.* (formats/frames/frames.md).
  Surfaces(const Image& image, bool seen);

  bool has_pixel(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  float albedo_at(std::size_t c, int x, int y) const { return albedo[c].empty() ? 1 : albedo[c].at(x, y); }

 private:
  void take_depth(const Channel* z);
  void take_albedo(const Image& image, const std::string& name);
  void take_edges(const Image& image);
};

}  // namespace tempolux
