// lib/scene/gltf_json.h -- parses the JSON of a glTF file and checks its types; private to the gate.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "lib/core/json.h"
#include "lib/scene/gltf_place.h"

namespace tempolux::gltf {

using Json = nlohmann::json;

/// Parses JSON. A first pass counts values and levels: at most 8 million values and 64 levels, so that a hostile file
/// can exhaust neither memory nor stack. Throws InputError that names the line.
Json parse_json(std::string_view text, const std::string& file);

/// An array of the document by its key; empty if it is missing.
const Json& array_of(const Json& document, const char* key);

/// Checks the type of every property of glTF 2.0 that is read later, and that required properties exist. Whole numbers
/// that are written with a fraction (3.0) become integers. Throws InputError that names the place.
void check_types(Json& document, const std::string& file);

/// Checks the properties of an extension's object at `place` likewise: KHR_draco_mesh_compression of a primitive, EXT_
/// or KHR_meshopt_compression of a bufferView, EXT_texture_webp of a texture.
void check_draco(Json& extension, const std::string& place, const std::string& file);
void check_meshopt(Json& extension, const std::string& place, const std::string& file);
void check_webp(Json& extension, const std::string& place, const std::string& file);

/// Removes all `extras` and all extensions whose name is not in `known`, since tinygltf needs 200 bytes for each of
/// their values. The names of removed extensions go to `unknown`. Throws InputError if the known extensions hold more
/// than a million values.
void prune(Json& document, const std::set<std::string>& known, std::set<std::string>& unknown, const std::string& file);

}  // namespace tempolux::gltf
