// lib/scene/scene_hash.h -- content hashes of a scene at a frame, by concern (formats/plan/plan.md).
//
// Content only: names, JSON order and unused parts of the file do not count. Materials are numbered by first
// use in node order, so the order of a file's material list does not count either.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// Nodes that do not count, by index: a hash is then that of the same scene without their meshes. Empty: all count.
using LeftOut = std::span<const std::uint8_t>;

/// Geometry of surfaces, in their order: object, winding, material number, positions, normals, texture
/// coordinates, triangles; and the origin they are relative to.
std::string geometry_hash(const Scene& scene, Vec3d origin, std::span<const Surface> surfaces, LeftOut left_out = {});
/// Reflecting properties of the materials in use, as evaluated at a frame, in order of first use. Emission belongs to
/// lights_hash.
std::string materials_hash(const Scene& scene, std::span<const Material> materials, LeftOut left_out = {});
/// Punctual lights where they stand, all triangles that emit, with what they emit, and the environment, if any.
std::string lights_hash(const Scene& scene, Vec3d origin, std::span<const PlacedLight> lights,
                        std::span<const Material> materials, std::span<const Surface> surfaces);
/// Participating media: none can be described yet, so a constant.
std::string media_hash();

}  // namespace tempolux
