// lib/scene/gltf_gate.h -- checks and rewrites a glTF file before tinygltf reads it.
//
// tinygltf is a parser, not a validator: it recurses as deep as the JSON nests, opens any path that a URI names, and
// takes values of the wrong type as missing. So the gate parses the JSON first, with limits, and checks it. Then it
// rewrites the JSON: images, extras and unknown extensions are removed (extras of nodes are kept separately), packed
// geometry is unpacked, and every buffer's URI is replaced by the name of an approved range of bytes.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/gltf_load.h"

namespace tempolux::gltf {

/// The bytes of a regular file that hold one buffer; without a path, bytes of Gated::unpacked.
struct ByteRange {
  std::string path;
  std::uint64_t offset = 0, length = 0;
};

/// Where the bytes of an image are: in a bufferView, a data URI or a file of its own, which must lie in the scene's
/// folder. The gate does not open the file: only images that a texture names are read.
struct GatedImage {
  std::string name;
  int buffer_view = -1;
  std::string base64;   ///< payload of a data URI
  std::string path;     ///< of a file
  std::string refused;  ///< the reason for which the image cannot be used; "": it can
};

/// A channel of KHR_animation_pointer.
struct PointerChannel {
  std::size_t animation = 0;
  int sampler = -1;
  /// The animated property, such as "/materials/2/pbrMetallicRoughness/roughnessFactor"; "": the file names none.
  std::string pointer;
};

/// A file that passed the gate.
struct Gated {
  std::string json;                ///< its buffers are named buffer_name(index), or are base64 data URIs
  std::vector<ByteRange> buffers;  ///< by index of the buffer; length 0: a data URI
  std::vector<GatedImage> images;  ///< by index of the image
  std::vector<std::string> files;  ///< the scene file and every file with a buffer, each once
  /// Geometry unpacked from Draco or meshopt (gltf_unpack.h); a buffer of its own.
  std::vector<unsigned char> unpacked;
  std::uint64_t byte_count = 0;       ///< size of the JSON and of all buffers
  std::vector<std::string> warnings;  ///< what the file has and this program does not read
  std::vector<PointerChannel> pointers;
  std::map<std::size_t, std::string> node_extras;  ///< by index of the node: its `extras` as JSON text
};

/// The name a buffer has in Gated::json.
std::string buffer_name(std::size_t index);

/// Reads the JSON of a .gltf or .glb file (distinguished by content) and checks, in this order: size, GLB chunks,
/// nesting (64 levels) and number of JSON values, types of all properties that are read, version, required extensions,
/// and URIs: each must be relative and name a regular file that is long enough and inside the scene's folder after
/// resolving symbolic links. Packed geometry is unpacked last. Throws InputError.
Gated pass_gate(const std::string& path, const GltfOptions& options);

/// Reads a range; throws InputError if the file ends first.
std::vector<unsigned char> read_range(const ByteRange& range);
/// Throws InputError with the scene's path and the place in it if the file that is named there does not exist.
void require_file(const std::string& named, const std::string& path, const std::string& place);
/// Reads a whole regular file of at most `max_bytes`; throws InputError otherwise.
std::vector<unsigned char> read_whole(const std::string& path, std::uint64_t max_bytes);

}  // namespace tempolux::gltf
