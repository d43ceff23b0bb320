// lib/scene/gltf_unpack.h -- geometry that a glTF file packs with Draco or meshopt; private to the gate.
#pragma once

#include <string>

#include "lib/scene/gltf_gate.h"
#include "lib/scene/gltf_json.h"

namespace tempolux::gltf {

/// Unpacks what the file has in no other form (lib/core/unpack.h: a helper process does it; none is started where
/// nothing is packed) and rewrites the document, so that nothing after the gate knows of it:
///
/// - KHR_draco_mesh_compression: accessors of the primitive get a bufferView with their plain values;
/// - EXT_meshopt_compression, KHR_meshopt_compression: the bufferView lies in the unpacked bytes;
/// - EXT_texture_webp: the texture's source is the WebP image, which is decoded when it is first looked at, like any
/// other.
///
/// The unpacked bytes are one more buffer at the end, Gated::unpacked. They may be wrong like those of any file:
/// accessors are checked later. What a file claims is limited: a thousand times its packed bytes and 64 MB, and
/// max_file_bytes.
///
/// Call after check_types, check_packing and the approval of buffers. Throws InputError that names primitive or
/// bufferView, the extension, and the command that unpacks the file.
void unpack_packed(Json& document, const std::string& path, const GltfOptions& options, Gated& gated);

}  // namespace tempolux::gltf
