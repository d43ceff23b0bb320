// lib/scene/gltf_pointer.h -- KHR_animation_pointer: finds the property that a JSON pointer names.
#pragma once

#include <string>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {

/// The property of an object that a pointer names.
struct PointedAt {
  AnimationTrack::Path path = AnimationTrack::Path::translation;
  int target = 0;            ///< index in the scene
  std::size_t property = 0;  ///< of a material: row of material_properties()
};

/// Finds the property that a pointer names. False, with a warning, if this program does not animate the property; false
/// if the node belongs to another scene of the file. Throws InputError if the object does not exist.
bool resolve_pointer(Import& import, const std::string& pointer, PointedAt& at);

/// Fills Scene::emission_factors and light_factors if a track animates a material or light.
void keep_factors(Import& import);

}  // namespace tempolux::gltf
