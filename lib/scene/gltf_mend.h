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
/// Polygonal Facets", 1998). Other normals and vertices without triangles stay. A vertex whose triangles have no area
/// or lie back to back has no normal: then all normals of the primitive are dropped, which means flat shading.
void mend_normals(Import& import, const std::string& place, const std::vector<std::uint32_t>& unusable,
                  Primitive& primitive);

/// Recomputes texture coordinates or colours of the vertices `unusable` (ascending): the mean over the usable vertices
/// with which each shares a triangle; 0 if there is none. `values` has `components` numbers for each vertex.
void mend_from_neighbours(const Primitive& primitive, const std::vector<std::uint32_t>& unusable,
                          std::span<float> values, std::size_t components);

}  // namespace tempolux::gltf
