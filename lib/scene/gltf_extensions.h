// lib/scene/gltf_extensions.h -- extensions that pack a glTF file's data, and the commands that unpack it; private to
// the gate.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "lib/scene/gltf_json.h"

namespace tempolux::gltf {

/// Refuses extensions outside `known` that the file requires or that hold images without another form: throws
/// InputError that names the extension, the place, and the command that makes a readable file. If the file also has the
/// image as PNG or JPEG, a warning says that this is used, and the extension goes to `handled`. Call after
/// check_types() and before prune().
void check_packing(const Json& document, const std::string& file, const std::set<std::string>& known,
                   std::set<std::string>& handled, std::vector<std::string>& warnings);

/// The remedy for a file with this unreadable extension.
std::string remedy_of(const std::string& name);

/// True if an object of the document has the extension.
bool has_extension(const Json& object, const char* name);
/// True if a buffer has no bytes and only reserves the size of unpacked bufferViews.
bool is_stand_in(const Json& buffer);
/// True if the data of a bufferView, or of an accessor of a primitive, is packed by the extension and has no other
/// form.
bool view_is_packed_only(const Json& document, const Json& view, const char* name);
bool primitive_is_packed_only(const Json& document, const Json& primitive, const char* name);

}  // namespace tempolux::gltf
