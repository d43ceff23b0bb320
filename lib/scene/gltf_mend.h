// lib/scene/gltf_mend.h -- replaces invalid numbers of a mesh: recomputes them from the rest of the mesh, or leaves
// them out.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {

/// Recomputes the normals of the vertices `unusable` (ascending). A normal is the mean of the normals of the triangles
/// around the vertex, weighted by the triangle's angle there (Thuermer, Wuethrich, "Computing Vertex Normals from
/// Polygonal Facets", 1998). Vertices without triangles keep their normals. If all triangles of a vertex have no area,
/// or their normals cancel, all normals of the primitive are dropped, which means flat shading.
void mend_normals(Import& import, const std::string& place, const std::vector<std::uint32_t>& unusable,
                  Primitive& primitive);

/// Recomputes texture coordinates or colours of the vertices `unusable` (ascending) as the mean over the usable
/// vertices of their triangles; 0 if there is no usable one. `values` has `components` numbers for each vertex.
void mend_from_neighbours(const Primitive& primitive, const std::vector<std::uint32_t>& unusable,
                          std::span<float> values, std::size_t components);

}  // namespace tempolux::gltf
