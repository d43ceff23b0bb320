// lib/scene/gltf_deform.h -- reads what changes a mesh's shape: morph targets and skins.
#pragma once

#include <string>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {

/// Reads displacements of POSITION and NORMAL; other attributes are ignored. Throws InputError if the number of
/// displacements is not the number of vertices.
void read_targets(Import& import, const tinygltf::Primitive& source, const std::string& place, Primitive& primitive);
/// Reads all JOINTS_n and WEIGHTS_n; the weights of a vertex are normalised to a sum of 1.
void read_influences(Import& import, const tinygltf::Primitive& source, const std::string& place, Primitive& primitive);

}  // namespace tempolux::gltf
