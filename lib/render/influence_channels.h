// lib/render/influence_channels.h -- where what moves matters, as a frame rendered from a localised cache has it.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/localised_light.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// The float channels "influence" (LocalisedLight::influence) and "blend" (gathered_share) at the first Lambert lobe
/// that the ray through the pixel's centre comes to, mirrors and glass passed by the likelier of reflection and
/// transmission; 0 where there is none. Where influence is infinite, as on what moves, the upper threshold stands for
/// it. Adds nothing unless `channels` has "influence"; InputError if it has and light is nullptr: there is no such
/// cache.
void add_influence_channels(const RenderScene& scene, const CameraView& view, const LocalisedLight* light,
                            const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
