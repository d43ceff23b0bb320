// lib/scene/gltf_unpack.h -- unpacks geometry that a glTF file packs with Draco or meshopt; private to the gate.
#pragma once

#include <string>

#include "lib/scene/gltf_gate.h"
#include "lib/scene/gltf_json.h"

namespace tempolux::gltf {

/// Unpacks data that the file has in no other form, and rewrites the document so that later readers need not know the
/// extensions. A child process unpacks (lib/core/unpack.h); it starts only if something is packed.
/// - KHR_draco_mesh_compression: accessors of the primitive get a bufferView with plain values.
/// - EXT_meshopt_compression, KHR_meshopt_compression: the bufferView points to unpacked bytes.
/// - EXT_texture_webp, EXT_texture_avif: a texture without a source gets this image as its source. It is decoded at its
///   first use like any other image.
/// The unpacked bytes become the last buffer, Gated::unpacked. They may be invalid like the bytes of any file, so
/// check_accessors() must check them. Their size is limited to a thousand times the packed bytes plus 64 MB, and to
/// max_file_bytes.
/// Call after check_types, check_packing and the approval of buffers. Throws InputError that names the primitive or
/// bufferView, the extension, and the command that unpacks the file.
void unpack_packed(Json& document, const std::string& path, const GltfOptions& options, Gated& gated);

}  // namespace tempolux::gltf
