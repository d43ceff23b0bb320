// lib/render/influence_channels.h -- channels that show where movers change the light of a localised cache.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/localised_light.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Adds the float channels "influence" (LocalisedLight::influence) and "blend" (gathered_share), if `channels` has
/// "influence". Both hold for the first Lambert lobe that the ray through the pixel's centre reaches; at mirrors and
/// glass the ray follows the likelier of reflection and transmission. 0 where there is no Lambert lobe. An infinite
/// influence, as on movers, is stored as the upper threshold. Throws InputError if "influence" is requested and `light`
/// is nullptr.
void add_influence_channels(const RenderScene& scene, const CameraView& view, const LocalisedLight* light,
                            const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
