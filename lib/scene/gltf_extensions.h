// lib/scene/gltf_extensions.h -- extensions that pack a glTF file's data, and the commands that unpack it; private to
// the gate.
#pragma once

#include <array>
#include <set>
#include <string>
#include <vector>

#include "lib/scene/gltf_json.h"

namespace tempolux::gltf {

/// Extensions of textures whose images are decoded.
inline constexpr std::array kImageExtensions{"EXT_texture_webp", "EXT_texture_avif"};

/// Throws InputError in two cases: the file requires an extension that is not in `known` and cannot be rendered without
/// the extension; or an image exists only in the format of an unknown extension. The message names the extension, the
/// place, and the command that makes a readable file. If the file also has the image in another format, `warnings` gets
/// a line, and the extension goes to `handled`. Call after check_types() and before prune().
void check_packing(const Json& document, const std::string& file, const std::set<std::string>& known,
                   std::set<std::string>& handled, std::vector<std::string>& warnings);

/// Words for the user: how to make a readable file from one that has this unreadable extension.
std::string remedy_of(const std::string& name);

/// True if an object of the document has the extension.
bool has_extension(const Json& object, const char* name);
/// Marks the buffers without bytes whose bufferViews are all packed by meshopt, as files may do themselves.
/// `has_chunk`: the file has a binary chunk, which is buffer 0.
void mark_stand_ins(Json& document, bool has_chunk);
/// True if a buffer has no bytes, since its bufferViews are packed by meshopt.
bool is_stand_in(const Json& buffer);
/// True if the extension packs a bufferView, or a primitive's accessors, and the file has no plain copy of all the
/// data.
bool view_is_packed_only(const Json& document, const Json& view, const char* name);
bool primitive_is_packed_only(const Json& document, const Json& primitive, const char* name);

}  // namespace tempolux::gltf
