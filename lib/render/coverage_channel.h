// lib/render/coverage_channel.h -- which of the neighbouring pixels' surfaces a pixel sees too, and how much of them.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// The uint channel "coverage": four bits for each of the eight pixels around (order: rows from the top, bits 0-3 the upper left one, 28-31 the
/// lower right one; the pixel itself is not among them): how many of 16 rays, spread evenly over the pixel, see the surface that
/// the neighbour's centre sees, the nearest such neighbour counted. The rest see the surface of the pixel's own centre, or one that
/// no pixel around it shows. 0: the pixel sees one surface. A count of 16 is written as 15.
///
/// Only pixels at edges (PixelSurfaces::edges) cost rays, 25 each; nothing is shaded. The rays do not depend on seed or frame. `image` holds Z,
/// N and id.object already; InputError names what is missing. Adds nothing unless `channels` has "coverage".
void add_coverage_channel(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
