// lib/render/seen_channels.h -- what mirrors and glass show in each pixel: features for filtering the layer specular.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Adds "seen.Z", "seen.N.X .Y .Z", "seen.id" and "seen.albedo.R .G .B" if `channels` has "seen". The ray through the
/// pixel's centre continues at sharp mirrors and glass (delta lobes, also those above a Lambert lobe), by the
/// likelier of reflection and transmission, up to 16 times, to the first surface without a delta lobe.
/// - Z: depth of the virtual image [m], at the length of the whole path along the pixel's ray. In a plane mirror 1/Z
/// is linear over pixels, as without a mirror. 0 where the path leaves the scene.
/// - N: normal of the last surface, on the side that the ray meets.
/// - id: object of the last surface; after mirrors a hash of all objects on the path.
/// - albedo: the share of uniform light that the last surface reflects by all lobes. Without a mirror on the path it
/// is the share of the S lobes alone, because the layer specular then holds no other light of this surface. 1 where
/// the path leaves the scene.
void add_seen_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       Image& image);

}  // namespace tempolux
