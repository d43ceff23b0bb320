// lib/scene/tangents.h -- computes tangents for meshes that have none.
#pragma once

#include "lib/scene/scene.h"

namespace tempolux {

/// Gives a primitive with normals the tangents of MikkTSpace for a normal map, which glTF 2.0, 3.7.2.1, requires where
/// the file has no tangents; also the displacements that morph targets add. Method: M. Mikkelsen, "Simulation of
/// Wrinkled Surfaces Revisited", master's thesis, University of Copenhagen 2008, chapter 3.
///
/// Corners with equal position, normal and texture coordinates are one vertex. Corners of a vertex share a tangent if
/// their triangles are joined by common edges and their coordinates have the same orientation. The tangent is the mean
/// over these triangles of the direction in which u grows, projected to the vertex' tangent plane, normalised, times
/// the corner's angle. A vertex whose corners get different tangents (where a mirrored image meets itself) is split:
/// new vertices are appended. Where texture coordinates have no area the tangent is zero. v grows downwards in glTF: if
/// u and v have the corners' orientation the sign is -1.
///
/// Texture coordinates are used after the texture's transform. Does nothing without texture coordinates or normals.
void make_tangents(Primitive& primitive, const Texture& normal_map);

}  // namespace tempolux
