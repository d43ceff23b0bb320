// lib/scene/gltf_extensions.h -- extensions that pack a glTF file's data, and what to run to unpack it; private
// to the gate.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "lib/scene/gltf_json.h"

namespace tempolux::gltf {

/// Refuses extensions outside `known` that the file calls required or that hold images it has in no other form:
/// throws InputError that names the extension, the place, and the command that makes a readable file. Where the file
/// also has the image as PNG or JPEG a warning says that this is read; those extensions go to `handled`. Call after
/// check_types() and before prune().
void check_packing(const Json& document, const std::string& file, const std::set<std::string>& known,
                   std::set<std::string>& handled, std::vector<std::string>& warnings);

/// What to do about a file whose extension of this name cannot be read.
std::string remedy_of(const std::string& name);

/// True if an object of the document has the extension.
bool has_extension(const Json& object, const char* name);
/// True if a buffer has no bytes and only stands for what unpacking its bufferViews gives.
bool is_stand_in(const Json& buffer);
/// True if a bufferView, or some accessor of a primitive, has its data packed by the extension and in no other form.
bool view_is_packed_only(const Json& document, const Json& view, const char* name);
bool primitive_is_packed_only(const Json& document, const Json& primitive, const char* name);

}  // namespace tempolux::gltf
