// lib/render/seen_channels.h -- what mirrors and glass show in each pixel: features by which light in them is filtered.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Adds "seen.Z", "seen.N.X .Y .Z", "seen.id" and "seen.albedo.R .G .B" if `channels` has "seen". The ray through the
/// pixel's centre goes on at sharp mirrors and glass (delta lobes, also those above a matte ground), by the likelier of
/// reflection and transmission, up to 16 times, to the first surface without one. Z: depth of the virtual image [m], at
/// the length of the whole way along the pixel's ray. In a plane mirror 1/Z is linear over pixels as it is without. 0
/// where the way ends in nothing. N: normal of the last surface on the side met. id: its object; after mirrors a hash
/// of all objects on the way. albedo: what the last surface reflects of uniform light by all lobes; without a mirror on
/// the way by its S lobes alone, as the layer specular holds no other light of it; 1 where the way ends in nothing.
void add_seen_channels(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels,
                       Image& image);

}  // namespace tempolux
