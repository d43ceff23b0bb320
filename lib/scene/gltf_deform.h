// lib/scene/gltf_deform.h -- what lets a mesh change its shape, as glTF stores it.
#pragma once

#include <string>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {

/// Displacements of POSITION and NORMAL; those of other attributes are not used. Throws InputError if there are not
/// as many as the primitive has vertices.
void read_targets(Import& import, const tinygltf::Primitive& source, const std::string& place, Primitive& primitive);
/// JOINTS_n and WEIGHTS_n for all n there are; weights of a vertex are brought to a sum of 1.
void read_influences(Import& import, const tinygltf::Primitive& source, const std::string& place, Primitive& primitive);

}  // namespace tempolux::gltf
