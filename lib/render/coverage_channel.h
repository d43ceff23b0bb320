// lib/render/coverage_channel.h -- how much a pixel sees of its neighbours' surfaces.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Adds two uint channels, if `channels` has "coverage".
///
/// "coverage" holds four bits for each of the eight neighbouring pixels, in rows from the top: bits 0-3 for the upper
/// left neighbour, bits 28-31 for the lower right one. The bits count how many of 16 rays, spread uniformly over the
/// pixel, see the surface that the neighbour's centre sees; if several neighbours see this surface, the closest one
/// counts. A count of 16 is stored as 15. "coverage.other" counts the rays that see a surface which neither the pixel's
/// own centre nor a neighbour's centre sees. All other rays see the surface of the pixel's own centre. If both channels
/// are 0, the pixel sees one surface.
///
/// Two hits are on one surface if they have the same object and material, the cosine between their normals is above
/// PixelSurfaces::kSameNormal, and each hit lies within a pixel's width of the other's plane. Costs nine rays per
/// pixel: one through the centre, and eight that search for surfaces which no centre sees, such as wires. Where these
/// rays and the centres of the neighbours see two surfaces, a pixel costs 16 further rays. Nothing is shaded. The rays
/// do not depend on seed or frame.
///
/// Returns by pixel 1 where one of the channels is not 0; empty without "coverage".
std::vector<std::uint8_t> add_coverage_channel(const RenderScene& scene, const CameraView& view,
                                               const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
