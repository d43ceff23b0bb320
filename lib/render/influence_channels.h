// lib/render/influence_channels.h -- channels that show where movers change the light of a localised cache.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/localised_light.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// If `channels` has "influence", adds the float channels "influence" (LocalisedLight::influence) and "blend"
/// (LocalisedLight::gathered_share). Their place is the first Lambert lobe that the ray through the pixel's centre
/// reaches (seen_through); 0 where there is none. An infinite influence, as on movers, is stored as the upper
/// threshold. Throws InputError if "influence" is requested and `light` is null.
void add_influence_channels(const RenderScene& scene, const CameraView& view, const LocalisedLight* light,
                            const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
