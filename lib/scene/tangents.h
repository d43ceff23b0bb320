// lib/scene/tangents.h -- computes tangents for meshes that have none.
#pragma once

#include "lib/scene/scene.h"

namespace tempolux {

/// Computes the tangents of a primitive for a normal map, and the displacements that morph targets add to them, by
/// MikkTSpace: glTF 2.0, 3.7.2.1, requires this where the file has no tangents. Method: M. Mikkelsen, "Simulation of
/// Wrinkled Surfaces Revisited", master's thesis, University of Copenhagen 2008, chapter 3.
///
/// Corners with equal position, normal and texture coordinates are one vertex. Corners of a vertex share a tangent if
/// common edges join their triangles and their texture coordinates have the same orientation. The tangent is the
/// normalised sum over these corners of the direction in which u grows, projected to the vertex' tangent plane and
/// normalised, times the corner's angle. A vertex whose corners get different tangents, as where a mirrored texture
/// meets itself, is split: new vertices are appended. Where texture coordinates have no area, the tangent is zero. v
/// grows downwards in glTF, so the sign is -1 if u and v have the corners' orientation.
///
/// The texture's transform is applied first. Does nothing without texture coordinates or normals.
void make_tangents(Primitive& primitive, const Texture& normal_map);

}  // namespace tempolux
