// lib/render/seen_channels.h -- the surface that mirrors and glass show in each pixel, for filters of layer specular.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Adds "seen.Z", "seen.N.X .Y .Z", "seen.id" and "seen.albedo.R .G .B" if `channels` has "seen". The ray through the
/// pixel's centre continues at mirrors and smooth glass (delta lobes, also those above a Lambert lobe), by the likelier
/// of reflection and transmission, up to kMostMirrors times. The first surface without a delta lobe has
/// - Z: depth of the virtual image [m], which lies on the pixel's ray at the length of the whole path. In a plane
/// mirror 1/Z is linear over pixels, as without a mirror. 0 where the path leaves the scene.
/// - N: shading normal, on the side that the ray meets.
/// - id: object; after mirrors a hash of all objects on the path.
/// - albedo: the share of uniform light that all lobes reflect. Without a mirror on the path it is the share of the
/// lobes S alone, because layer specular then holds no other light of this surface. 1 where the path leaves the scene.
void add_seen_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       Image& image);

}  // namespace tempolux
