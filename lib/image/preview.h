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
  std::string layer;                         ///< "" is RGB; or "indirect", "Z", "N", "id.object", "P" ...
  std::optional<double> exposure_stops;      ///< absent: auto, so that the layer's 98th percentile luminance maps to 0.9
};

/// Exposure in stops that "auto" chooses for a layer; use one value for a whole sequence.
double auto_exposure_stops(const Image& image, const std::string& layer);

/// Colour layers: 2^stops, then sRGB transfer, clipped at 1. Z: near bright, far dark; N: n/2+1/2; ids: a
/// colour per id; signed layers (differences): grey 0, red above, blue below if any value is negative.
Picture make_picture(const Image& image, const PreviewOptions& options);

/// Frames in a grid, `columns` wide (0: about square), 2 px gaps, each shrunk by box filter to at most max_width px.
Picture contact_sheet(const std::vector<Picture>& pictures, int columns, int max_width);

/// Writes a PNG (8-bit RGB) at exactly this path. Throws ResourceError.
void save_png(const std::string& path, const Picture& picture);

}  // namespace tempolux
