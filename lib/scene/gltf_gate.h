// lib/scene/gltf_gate.h -- checks and rewrites a glTF file before tinygltf reads it.
//
// tinygltf is a parser, not a validator: it recurses as deep as the JSON nests, opens any path that a URI names, and
// treats values of the wrong type as missing. So the gate parses the JSON first, with limits, and checks it. Then the
// gate rewrites the JSON: it removes images, extras and unknown extensions, unpacks packed geometry, and replaces the
// URI of every buffer by the name of an approved range of bytes. Images, extras of nodes and lights, and lens shifts
// are kept in Gated.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/gltf_load.h"

namespace tempolux::gltf {

/// The bytes of a file that hold one buffer; without a path, the bytes of Gated::unpacked.
struct ByteRange {
  std::string path;
  std::uint64_t offset = 0, length = 0;
};

/// Where the bytes of an image are: in a bufferView, in a data URI, or in a file of its own in the scene's folder. The
/// gate does not open the file, since only images that a texture names are read.
struct GatedImage {
  std::string name;
  int buffer_view = -1;
  std::string base64;   ///< payload of a data URI
  std::string path;     ///< of a file
  std::string refused;  ///< why the image cannot be used; "": it can be used
};

/// A channel of KHR_animation_pointer.
struct PointerChannel {
  std::size_t animation = 0;
  int sampler = -1;
  /// JSON pointer of the animated property: "/materials/2/pbrMetallicRoughness/roughnessFactor"; "": the file has none.
  std::string pointer;
};

/// A file that passed the gate.
struct Gated {
  std::string json;                ///< the rewritten JSON: URIs of buffers are buffer_name(index) or base64 data URIs
  std::vector<ByteRange> buffers;  ///< by index of the buffer; length 0: a data URI
  std::vector<GatedImage> images;  ///< by index of the image
  std::vector<std::string> files;  ///< the scene file and every file with a buffer, each once
  /// One buffer of geometry unpacked from Draco or meshopt (gltf_unpack.h).
  std::vector<unsigned char> unpacked;
  std::uint64_t byte_count = 0;       ///< size of the JSON and of all buffers
  std::vector<std::string> warnings;  ///< features of the file that this program ignores, one line each
  std::vector<PointerChannel> pointers;
  std::map<std::size_t, std::string> node_extras;            ///< by index of the node: its `extras` as JSON text
  std::map<std::size_t, std::string> light_extras;           ///< by index of the light: its `extras` as JSON text
  std::map<std::size_t, std::array<double, 2>> lens_shifts;  ///< by index of the camera: its extras' `lens_shift`
};

/// The name a buffer has in Gated::json.
std::string buffer_name(std::size_t index);

/// Reads the JSON of a .gltf or .glb file, which are distinguished by content. Checks in this order: size, GLB chunks,
/// nesting (64 levels) and number of JSON values, types of all properties that are read, version, required extensions,
/// URIs. A URI must be relative and name a file that is long enough and, after resolving symbolic links, inside the
/// scene's folder. Packed geometry is unpacked last. Throws InputError.
Gated pass_gate(const std::string& path, const GltfOptions& options);

/// Reads the bytes of a range of a file. Throws InputError if the file is too short.
std::vector<unsigned char> read_range(const ByteRange& range);
/// Throws InputError if the file `named` does not exist; `path` is the scene's, `place` the place in it, for messages.
void require_file(const std::string& named, const std::string& path, const std::string& place);
/// Reads a whole regular file of at most `max_bytes`; throws InputError otherwise.
std::vector<unsigned char> read_whole(const std::string& path, std::uint64_t max_bytes);

}  // namespace tempolux::gltf
