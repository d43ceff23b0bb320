// lib/scene/gltf_pointer.h -- KHR_animation_pointer: which property a JSON pointer means.
#pragma once

#include <string>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {

struct PointedAt {
  AnimationTrack::Path path = AnimationTrack::Path::translation;
  int target = 0;  ///< index of the scene
};

/// True if the property is one that is played; otherwise it is noted as ignored, with the pointer. Throws
/// InputError if the object pointed at does not exist.
bool resolve_pointer(Import& import, const std::string& pointer, PointedAt& at);

/// Fills Scene::emission_factors and light_factors if a track needs them.
void keep_factors(Import& import);

}  // namespace tempolux::gltf
