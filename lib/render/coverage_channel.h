// lib/render/coverage_channel.h -- which of the neighbouring pixels' surfaces a pixel sees too, and how much of them.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// The uint channel "coverage": four bits for each of the eight pixels around (order: rows from the top, bits 0-3 the
/// upper left one, 28-31 the lower right one; the pixel itself is not among them): how many of 16 rays, spread evenly
/// over the pixel, see the surface that the neighbour's centre sees, the nearest such neighbour counted. A count of 16
/// is written as 15. The uint channel "coverage.other": how many see a surface that neither the pixel's own centre nor
/// one around it sees. All others see that of its own centre. Both 0: the pixel sees one surface.
///
/// One surface: the same object and material, normals within PixelSurfaces::kSameNormal, planes that pass within a
/// pixel of the other point. Costs one ray for each pixel and 16 more where its centre and one around it see two
/// surfaces; nothing is shaded. The rays do not depend on seed or frame. Adds nothing unless `channels` has "coverage".
void add_coverage_channel(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                          Image& image);

}  // namespace tempolux
