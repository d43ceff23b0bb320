// lib/scene/tangents.h -- tangents of a mesh that comes without them.
#pragma once

#include "lib/scene/scene.h"

namespace tempolux {

/// Gives a primitive with normals the tangents of MikkTSpace for a normal map, as glTF 2.0, 3.7.2.1, asks where the
/// file has none: also what every morph target adds to them. Method: M. Mikkelsen, "Simulation of Wrinkled Surfaces
/// Revisited", master's thesis, University of Copenhagen 2008, chapter 3.
///
/// Corners with equal position, normal and texture coordinates are one vertex; those of it that are joined by
/// triangles with common edges, whose coordinates turn the same way, share a tangent: the mean over their triangles of
/// the direction in which u grows, laid into the vertex' tangent plane, unit, times the angle of the corner. A vertex
/// whose corners get different tangents (where a mirrored image meets itself) becomes several: new vertices follow the
/// old ones. Of corners whose triangles say nothing (coordinates without area) the tangent is zero.
/// v grows downwards in glTF: where u and v turn as the corners do the side is -1.
///
/// Texture coordinates count as the texture's transform leaves them. Nothing is done without them, or without normals.
void make_tangents(Primitive& primitive, const Texture& normal_map);

}  // namespace tempolux
