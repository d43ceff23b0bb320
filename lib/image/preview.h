// lib/image/preview.h -- converts frames to 8-bit pictures for viewing: tone curve, PNG, contact sheets.
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

/// What make_picture() shows.
struct PreviewOptions {
  std::string layer;                     ///< "" is RGB; or "indirect", "Z", "N", "id.object", "P" ...
  std::optional<double> exposure_stops;  ///< missing: auto_exposure_stops()
};

/// The exposure in stops that "auto" chooses for a layer: log2(0.9 / L). L is the 98th percentile over the pixels
/// (nearest rank) of the luminance, or of the largest |component| if the layer is signed or no colour. If L is 0, the
/// largest value replaces it. Returns 0 for a layer that is 0 everywhere, and for Z, N, P and ids. Values that are not
/// finite do not count. A sequence should use one value for all frames. Throws InputError that lists the channels if
/// the image has no layer of this name.
double auto_exposure_stops(const Image& image, const std::string& layer);

/// Converts a layer to a picture by its kind:
///
///     colour L.R .G .B     2^stops, then sRGB transfer, clipped to [0, 1]
///     signed colour        if values below 0 hold more than 2 % of all magnitudes, as in differences:
///                          0 is grey, above 0 red, below 0 blue; brightness is that of 2^stops |d|, clipped, sRGB
///                          transfer, with d the component of largest magnitude
///     Z                    linear from the 1st percentile (bright, 1) to the 99th (dark, 0.1);
///                          black where no surface is seen (infinite or >= 1e10)
///     N or any L.X .Y .Z   with values in [-1, 1]: n/2 + 1/2; P and other vectors: each axis over its range
///     L.u .v (motion)      grey without motion; u on red, v on green; |u| 2^stops = 1 is full
///     ids                  a colour per id; 0xffffffff (no object) is black
///     any other channel    grey, as a colour
///
/// Values that are not finite are black. Throws as auto_exposure_stops.
Picture make_picture(const Image& image, const PreviewOptions& options);

/// Puts pictures into a grid, `columns` wide (0: about square), with black gaps of 2 px. A picture wider than max_width
/// px is shrunk to that width by a box filter over linear light. Cells are as large as the largest picture; each
/// picture lies at the top left of its cell. Throws std::invalid_argument if there are no pictures, one is empty,
/// columns < 0 or max_width < 1.
Picture contact_sheet(const std::vector<Picture>& pictures, int columns, int max_width);

/// Draws an amber border along the picture's edge, a fortieth of the width wide and at least 2 px.
void mark(Picture& picture);

/// Writes a PNG (8-bit RGB) at exactly this path. Throws ResourceError.
void save_png(const std::string& path, const Picture& picture);

}  // namespace tempolux
