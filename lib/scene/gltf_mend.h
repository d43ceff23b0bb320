// lib/scene/gltf_mend.h -- numbers of a mesh that are no numbers: made anew from the rest of the mesh, or left out.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {

/// The normals of the vertices `unusable` (ascending) from the triangles around each: the mean of their normals,
/// weighted by the angle of the triangle at the vertex, as exporters make them (Thuermer, Wuethrich, "Computing Vertex
/// Normals from Polygonal Facets", 1998). The others are kept. Vertices of no triangle are passed over. A vertex whose
/// triangles have no area or lie back to back has no normal: then all normals of the primitive are dropped, which means
/// flat shading.
void mend_normals(Import& import, const std::string& place, const std::vector<std::uint32_t>& unusable,
                  Primitive& primitive);

/// Texture coordinates or colours of the vertices `unusable` (ascending): the mean of those of the vertices with which
/// each shares a triangle; 0 where none of these is usable. `values` has `components` numbers for each vertex.
void mend_from_neighbours(const Primitive& primitive, const std::vector<std::uint32_t>& unusable,
                          std::span<float> values, std::size_t components);

}  // namespace tempolux::gltf
