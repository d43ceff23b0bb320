// lib/image/preview.h -- frames as 8-bit pictures to look at: tone curve, PNG, contact sheets.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// 8-bit sRGB pixels, 3 bytes each, row 0 on top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

struct PreviewOptions {
  std::string layer;                     ///< "" is RGB; or "indirect", "Z", "N", "id.object", "P" ...
  std::optional<double> exposure_stops;  ///< absent: auto, so that the layer's 98th percentile luminance maps to 0.9
};

/// Exposure in stops that "auto" chooses for a layer; use one value for a whole sequence.
/// log2(0.9 / L), L the 98th percentile (nearest rank) over the pixels of the absolute luminance; of the
/// largest |component| where the layer is signed or no colour. If L is 0, the largest value
/// takes its place; 0 stops for a layer that is 0 everywhere, for Z, N, P and ids. Not finite values are left
/// out. Throws InputError naming what there is if the image has neither layer nor channel of this name.
double auto_exposure_stops(const Image& image, const std::string& layer);

/// The layer as a picture, by what it holds:
///   colour L.R .G .B    2^stops, then sRGB transfer, clipped to [0, 1]
///   signed colour       (values below 0 are more than 2 % of the sum of all magnitudes: differences) the component of
///                       largest magnitude d as 2^stops |d|, clipped, sRGB transfer; 0 grey, above red, below blue
///   Z                   linear between the 1st and the 99th percentile, near bright (1), far dark (0.1), nothing
///                       (infinite or >= 1e10) black
///   N or any L.X .Y .Z  of values in [-1, 1]: n/2 + 1/2; P and other vectors: each axis over the range of its values
///   L.u .v (motion)     no motion grey; u on red, v on green, |u| 2^stops = 1 full
///   ids                 a colour per id; 0xffffffff (nothing) black
///   any other channel   grey, as colour
/// Not finite values are black. Throws as auto_exposure_stops.
Picture make_picture(const Image& image, const PreviewOptions& options);

/// Frames in a grid, `columns` wide (0: about square), 2 px black gaps, each shrunk to at most max_width px
/// by a box filter over linear light, never enlarged, at the top left of its cell; cells are as large as the
/// largest picture. Throws std::invalid_argument if there are no pictures, one is empty, columns < 0 or
/// max_width < 1.
Picture contact_sheet(const std::vector<Picture>& pictures, int columns, int max_width);

/// Draws a border, a fortieth of the width wide and 2 px at least, along the picture's edge, in amber.
void mark(Picture& picture);

/// Writes a PNG (8-bit RGB) at exactly this path. Throws ResourceError.
void save_png(const std::string& path, const Picture& picture);

}  // namespace tempolux
