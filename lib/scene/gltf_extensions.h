// lib/scene/gltf_extensions.h -- extensions that pack a glTF file's data, and what to run to unpack it; private
// to the gate.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "lib/scene/gltf_json.h"

namespace tempolux::gltf {

/// Refuses extensions outside `known` that the file calls required or that hold data it has in no other form:
/// throws InputError that names the extension, the place, and the command that makes a readable file. Of an extension
/// that packs data which the file also holds unpacked (a fallback) a warning says that the unpacked copy is
/// read; those extensions go to `handled`. Call after check_types() and before prune().
void check_packing(const Json& document, const std::string& file, const std::set<std::string>& known,
                   std::set<std::string>& handled, std::vector<std::string>& warnings);

}  // namespace tempolux::gltf
