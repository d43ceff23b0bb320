// lib/core/unpack.h -- unpacks data packed by Draco, meshoptimizer, WebP or AVIF, in the child program tempolux-decode.
//
// libdraco reads beyond its input on damaged files (google/draco pull request 1214), so none of these libraries runs in
// this process. The child's output is untrusted like the bytes of any file: its readers check it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tempolux {

/// The program that packed a piece of data. The comment of each packer lists its settings, in order, and the form of
/// the unpacked data. Unpacked data that differs from the sizes and counts in the settings is refused.
enum class Packer : std::uint32_t {
  /// Settings: bytes of an index (0: no indices), number of indices, number of vertices, number of attributes; then
  /// for each attribute its id in the Draco data, glTF's component type (5120 to 5126) and the numbers per vertex.
  /// Unpacked: the indices, then the attributes one after the other, all without padding.
  draco = 1,
  /// Settings: MeshoptMode, MeshoptFilter, number of elements, bytes of an element. Unpacked: the elements.
  meshopt = 2,
  /// Settings: width and height in pixels, number of channels (3: R, G, B; 4: also alpha). Unpacked: 8 bits per
  /// channel, the top row first.
  webp = 3,
  /// Settings and unpacked data as for WebP, always with 4 channels; depths above 8 bits are rounded to 8.
  avif = 4,
};
enum class MeshoptMode : std::uint32_t { attributes, triangles, indices };
enum class MeshoptFilter : std::uint32_t { none, octahedral, quaternion, exponential };

/// One piece of packed data.
struct PackedPiece {
  Packer packer = Packer::draco;
  std::vector<std::uint32_t> settings;
  std::vector<unsigned char> bytes;
  std::uint64_t unpacked_bytes = 0;  ///< from the settings; at least 1
  std::string place;                 ///< "FILE: PLACE"; begins messages
  std::string remedy;                ///< what the user can do if the data cannot be unpacked; ends messages
};

/// First number of the child's input; the child refuses another version. The pieces follow. A piece is: packer, number
/// of settings, settings (all 32 bits), number of bytes, number of unpacked bytes (64 bits), bytes. All numbers are
/// little-endian, without padding. The child prints the unpacked bytes of all pieces in order. At the first piece that
/// it cannot unpack, it writes a line to standard error and ends with code 2.
inline constexpr std::uint32_t kUnpackVersion = 1;

/// The unpacked bytes of all pieces, one after the other. One child is started for all pieces, none if there are no
/// pieces.
///
/// Its limits follow from the sizes. Memory: 256 MiB, twice the packed and 20 times the unpacked bytes of the largest
/// piece (Draco takes most: 6 times, for a sphere of 10^6 triangles with normals and texture coordinates; about 12
/// times with 16-bit indices and positions only). Processor time: 20 s, and one second per unpacked MB (Draco is the
/// slowest: 65 MB per second). The memory limit is never above memory_that_fits().
///
/// Throws InputError "PLACE: WHAT; REMEDY" for the first piece that the child cannot unpack or on which it dies, or if
/// the program is missing; ResourceError if it cannot be started.
std::vector<unsigned char> unpack(const std::vector<PackedPiece>& pieces);

}  // namespace tempolux
