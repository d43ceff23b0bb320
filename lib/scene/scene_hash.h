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

/// Marks nodes (by index) that are left out: the hash is then that of the scene without their meshes. Empty: no node is
/// left out.
using LeftOut = std::span<const std::uint8_t>;

/// Geometry of surfaces in order: object, winding, material number, positions, normals, texture coordinates and
/// triangles; and the origin of their coordinates.
std::string geometry_hash(const Scene& scene, Vec3d origin, std::span<const Surface> surfaces, LeftOut left_out = {});
/// Reflecting properties of the materials in use at a frame, in order of first use. Emission belongs to lights_hash.
std::string materials_hash(const Scene& scene, std::span<const Material> materials, LeftOut left_out = {});
/// Placed punctual lights, all emitting triangles with their emission, and the environment.
std::string lights_hash(const Scene& scene, Vec3d origin, std::span<const PlacedLight> lights,
                        std::span<const Material> materials, std::span<const Surface> surfaces);
/// Participating media: a constant, since scenes do not describe media.
std::string media_hash();

}  // namespace tempolux
