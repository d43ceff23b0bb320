// lib/scene/gltf_deform.h -- reads what changes a mesh's shape: morph targets and skins.
#pragma once

#include <string>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {

/// Reads the morph targets of a primitive: displacements of POSITION, NORMAL and, if the primitive has tangents,
/// TANGENT. Throws InputError if the number of displacements is not the number of vertices.
void read_targets(Import& import, const tinygltf::Primitive& source, const std::string& place, Primitive& primitive);
/// Reads all JOINTS_n and WEIGHTS_n, and normalises the weights of each vertex to a sum of 1. Invalid weights become 0.
/// Throws InputError for invalid joints.
void read_influences(Import& import, const tinygltf::Primitive& source, const std::string& place, Primitive& primitive);

}  // namespace tempolux::gltf
