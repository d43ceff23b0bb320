// lib/scene/gltf_load.h -- loads a glTF 2.0 file, .gltf or .glb. Its parts are gltf_*.h, private to this folder.
#pragma once

#include <cstdint>
#include <string>

#include "lib/image/texture_images.h"
#include "lib/scene/scene.h"

namespace tempolux {

/// What load_gltf() reads, and its limits.
struct GltfOptions {
  std::string animation{};                    ///< plays only the animation of this name; empty: all together
  std::uint64_t max_file_bytes = 4ull << 30;  ///< of the scene file, of each buffer and of each image
  TextureLimits textures{};
};

/// Reads and checks a scene. Every value of the file is checked before it is used as a size, an index or a depth of
/// recursion: nesting, required extensions and URIs before tinygltf reads the file; accessors, indices, numbers and the
/// node graph afterwards. Images are not decoded.
///
/// Throws InputError "FILE: PLACE: WHAT; REMEDY" for unusable input, ResourceError if memory is short. Lists ignored
/// features in Scene::warnings. Allocates at most kGrowth times the size of the files for geometry.
Scene load_gltf(const std::string& path, const GltfOptions& options = {});

}  // namespace tempolux
