// lib/core/unpack.h -- data packed by Draco, meshoptimizer or WebP, unpacked by the helper program tempolux-decode.
//
// libdraco reads beyond its input on damaged files (google/draco pull request 1214), so none of these libraries runs in
// this process. What the helper gives back is bytes like those of any file: whoever reads them checks them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tempolux {

/// What packed a piece of data, and what its settings mean, in this order. Sizes and counts are what the unpacked data
/// must have: other data is refused.
enum class Packer : std::uint32_t {
  /// Bytes of an index (0: no indices are wanted), number of indices, number of vertices, number of attributes, and for
  /// each
  /// attribute its id in the Draco data, glTF's component type (5120 to 5126) and the numbers per vertex. Unpacked: the
  /// indices, then the attributes one after the other, all without padding.
  draco = 1,
  /// MeshoptMode, MeshoptFilter, number of elements, bytes of an element. Unpacked: the elements.
  meshopt = 2,
  /// Width and height in pixels, channels: 3 for RGB, 4 for RGB and alpha. Unpacked: 8 bits each, row 0 on top.
  webp = 3,
};
enum class MeshoptMode : std::uint32_t { attributes, triangles, indices };
enum class MeshoptFilter : std::uint32_t { none, octahedral, quaternion, exponential };

/// One piece of packed data.
struct PackedPiece {
  Packer packer = Packer::draco;
  std::vector<std::uint32_t> settings;
  std::vector<unsigned char> bytes;
  std::uint64_t unpacked_bytes = 0;  ///< as the settings have it; at least 1
  std::string place;                 ///< "FILE: PLACE"; messages begin with it
  std::string remedy;                ///< what to do about data that cannot be unpacked; messages end with it
};

/// First number of the helper's input; another: it is of another version. After it each piece: packer, number of
/// settings, settings (all of 32 bits), number of bytes, of unpacked bytes (64 bits), bytes. Little-endian, without
/// padding. The helper prints the unpacked bytes of one piece after the other. At the first that it cannot unpack it
/// writes a line to its standard error and ends with code 2.
inline constexpr std::uint32_t kUnpackVersion = 1;

/// The unpacked bytes of all pieces, one after the other. One helper is started for all; none if there are no pieces.
///
/// Its limits follow from the sizes: memory 256 MiB, twice the packed and 20 times the unpacked bytes of the largest
/// piece (Draco takes most: 6 times, on a sphere of 10^6 triangles with normals and texture coordinates; some 12 times
/// with indices of 16 bits and positions alone); processor time 20 s and one second per unpacked MB (Draco is the
/// slowest: 65 MB in a second). Never more memory than fits the machine (memory_that_fits).
///
/// Throws InputError "PLACE: WHAT; REMEDY" for the first piece that the helper cannot unpack or on which it dies, or if
/// the helper is missing; ResourceError if it cannot be started.
std::vector<unsigned char> unpack(const std::vector<PackedPiece>& pieces);

}  // namespace tempolux
