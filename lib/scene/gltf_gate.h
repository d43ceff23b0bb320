// lib/scene/gltf_gate.h -- what a glTF file must pass before tinygltf sees it.
//
// tinygltf is a parser, not a validator: it recurses as deep as the JSON nests, opens any path a URI names
// and takes wrong types for missing ones. So the JSON is parsed here first, with limits, checked, and handed
// on rewritten: images, extras (but those of nodes, kept beside) and unknown extensions gone, packed geometry unpacked,
// every buffer's URI replaced by the name of a byte range that the gate has approved.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/gltf_load.h"

namespace tempolux::gltf {

/// Bytes of a regular file that hold one buffer; without a path those of Gated::unpacked.
struct ByteRange {
  std::string path;
  std::uint64_t offset = 0, length = 0;
};

/// Where the bytes of an image are: in a bufferView, a data URI or a file of their own, which must lie in the scene's
/// folder. It is not opened by the gate: only what a texture names is read.
struct GatedImage {
  std::string name;
  int buffer_view = -1;
  std::string base64;   ///< payload of a data URI
  std::string path;     ///< of a file
  std::string refused;  ///< why the image cannot be used, should a texture name it; "": it can
};

/// A channel of KHR_animation_pointer.
struct PointerChannel {
  std::size_t animation = 0;
  int sampler = -1;
  std::string pointer;  ///< such as "/materials/2/pbrMetallicRoughness/roughnessFactor"; "": not said
};

/// A file that passed.
struct Gated {
  std::string json;                     ///< buffers are named by buffer_name(index) or are base64 data URIs
  std::vector<ByteRange> buffers;       ///< by index of the buffer; length 0: a data URI
  std::vector<GatedImage> images;       ///< by index of the image
  std::vector<std::string> files;       ///< the scene file and every file a buffer lies in, each once
  std::vector<unsigned char> unpacked;  ///< what Draco or meshopt had packed (gltf_unpack.h); a buffer of its own
  std::uint64_t byte_count = 0;         ///< size of the JSON and of all buffers
  std::vector<std::string> warnings;    ///< what the file has and nothing here reads
  std::vector<PointerChannel> pointers;
  std::map<std::size_t, std::string> node_extras;  ///< by index of the node: its `extras` as JSON text
};

/// The name a buffer has in Gated::json.
std::string buffer_name(std::size_t index);

/// Reads the JSON of a .gltf or .glb file (told apart by content) and checks, in this order: size, GLB
/// chunks, nesting (64 levels) and number of JSON values, types of all properties that are read, version,
/// required extensions, and where URIs lead: relative, inside the scene's folder (symbolic links resolved),
/// regular files that are long enough. Packed geometry is unpacked last. Throws InputError.
Gated pass_gate(const std::string& path, const GltfOptions& options);

/// Reads a range; throws InputError if the file ends first.
std::vector<unsigned char> read_range(const ByteRange& range);
/// Throws InputError, with the scene's path and the place in it, unless the file that it names there is there.
void require_file(const std::string& named, const std::string& path, const std::string& place);
/// Reads a whole regular file of at most `max_bytes`; InputError otherwise.
std::vector<unsigned char> read_whole(const std::string& path, std::uint64_t max_bytes);

}  // namespace tempolux::gltf
