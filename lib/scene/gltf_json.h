// lib/scene/gltf_json.h -- JSON of a glTF file with its types checked; private to the gate.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>

namespace tempolux::gltf {

using Json = nlohmann::json;

/// Parses text after a first pass that counts: at most 64 levels and 8 million values, so that neither
/// stack nor memory depend on what a hostile file asks for. Throws InputError with the line.
Json parse_json(std::string_view text, const std::string& file);

/// A property of the document that is an array; an empty one if it is not there.
const Json& array_of(const Json& document, const char* key);

/// Checks that every property of glTF 2.0 that is read later has its type, and that required ones are
/// there; whole numbers written with a fraction (3.0) become integers. Throws InputError naming the place.
void check_types(Json& document, const std::string& file);

/// The same for an extension's object at `place`: KHR_draco_mesh_compression of a primitive, EXT_ and
/// KHR_meshopt_compression of a bufferView, EXT_texture_webp of a texture.
void check_draco(Json& extension, const std::string& place, const std::string& file);
void check_meshopt(Json& extension, const std::string& place, const std::string& file);
void check_webp(Json& extension, const std::string& place, const std::string& file);

/// Removes all `extras` and all extensions whose name is not in `known`, which tinygltf would copy into
/// values of 200 bytes each; the names found go to `unknown`. Throws InputError if the known ones hold more
/// than a million values.
void prune(Json& document, const std::set<std::string>& known, std::set<std::string>& unknown, const std::string& file);

}  // namespace tempolux::gltf
