// lib/scene/scene_hash.h -- content hashes of a scene at a frame, by concern (formats/plan/plan.md).
//
// Only content counts: not names, the order of the JSON text, or unused parts of the file. Materials are numbered by
// first use in node order, so the order of a file's material list does not count either.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// For each node, 1 if the hash excludes its mesh, as if the scene did not have it. Empty: no mesh is excluded.
using LeftOut = std::span<const std::uint8_t>;

/// Hash of the geometry of surfaces in their order: object, winding, material number, positions, normals, texture
/// coordinates and triangles; and of the origin of their coordinates.
std::string geometry_hash(const Scene& scene, Vec3d origin, std::span<const Surface> surfaces, LeftOut left_out = {});
/// Hash of the scattering properties of the materials in use at a frame, in order of first use. lights_hash() has their
/// emission.
std::string materials_hash(const Scene& scene, std::span<const Material> materials, LeftOut left_out = {});
/// Hash of the placed punctual lights, all emitting triangles with their emission, and the environment.
std::string lights_hash(const Scene& scene, Vec3d origin, std::span<const PlacedLight> lights,
                        std::span<const Material> materials, std::span<const Surface> surfaces);
/// Hash of the participating media: a constant. SceneInput replaces it by the hash of the voxels that it has read.
std::string media_hash();

}  // namespace tempolux
