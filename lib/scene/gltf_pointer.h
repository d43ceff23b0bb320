// lib/scene/gltf_pointer.h -- KHR_animation_pointer: finds the property that a JSON pointer names.
#pragma once

#include <string>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {

struct PointedAt {
  AnimationTrack::Path path = AnimationTrack::Path::translation;
  int target = 0;  ///< index in the scene
};

/// True if the property can be animated; otherwise the pointer is listed as ignored. Throws InputError if the object
/// does not exist.
bool resolve_pointer(Import& import, const std::string& pointer, PointedAt& at);

/// Fills Scene::emission_factors and light_factors if a track needs them.
void keep_factors(Import& import);

}  // namespace tempolux::gltf
