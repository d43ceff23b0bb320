// formats/photons/photons.h -- read and write .photons files, version 1.
//
// photons.md is the definition of the format. If this code and that text disagree, the text is right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/error.h"
#include "formats/identity.h"

namespace tempolux::formats {

/// How light reached the photon, in Heckbert's notation (photons.md).
enum class PathKind : std::uint8_t { direct = 0, caustic = 1, indirect = 2, volume = 3 };

/// One photon: a packet of flux that arrived at a point. 32 bytes, in memory as on disk.
struct Photon {
  std::array<float, 3> position{};   ///< m; world space minus the header's origin
  std::array<float, 3> flux{};       ///< W, linear Rec. 709; already divided by the number of emitted paths
  std::array<std::uint16_t, 2> normal{};  ///< octahedral: surface normal on the side the light arrived at
  std::uint16_t object = 0xffff;     ///< id.object; 0xffff in a medium
  PathKind kind = PathKind::direct;
  std::uint8_t bounce = 0;           ///< scattering events since the light, saturating at 255

  bool operator==(const Photon&) const = default;
};
static_assert(sizeof(Photon) == 32);

/// Octahedral encoding of a unit vector in two 16-bit numbers, and back (unit length to 1e-7).
std::array<std::uint16_t, 2> encode_normal(std::array<float, 3> n);
std::array<float, 3> decode_normal(std::array<std::uint16_t, 2> code);

/// Optional columns: present for every photon of the file or for none.
enum PhotonColumns : std::uint32_t {
  column_direction = 1,   ///< 4 bytes, octahedral wi: points back to where the light came from
  column_albedo = 2,      ///< 4 bytes RGBE-free: 3 x 8-bit reflected share + 1 zero byte
};

/// What the header says.
struct PhotonHeader {
  std::string history;                        ///< one line per tool, each ending in LF
  Identity identity;                          ///< which scene state this belongs to; may be empty
  std::array<double, 3> origin{};             ///< m, world space
  std::uint32_t columns = 0;                  ///< PhotonColumns
  std::uint32_t group_count = 1;              ///< N_g: photon i is of group i mod N_g
  std::uint64_t emitted_count = 0;            ///< paths started, over all groups
  std::string map = "global";                 ///< "global", "static" or "dynamic" (signed)
  std::string kinds = "direct,caustic,indirect";  ///< which kinds were stored
  /// Of an overlay: the file it changes, and that file's digest. Groups not in this file come from the base.
  std::string base_name, base_digest;
};

/// Photons of one group. Blocks of a group follow each other; groups ascend.
struct PhotonBlock {
  std::uint32_t group = 0;
  std::vector<Photon> photons;
  std::vector<std::array<std::uint16_t, 2>> directions;   ///< if column_direction
  std::vector<std::array<std::uint8_t, 4>> albedos;       ///< if column_albedo
};

/// Closing totals; summed over all groups of the file (of an overlay: over the groups it holds).
struct PhotonTotals {
  std::uint64_t photon_count = 0;
  std::array<double, 3> stored_flux{};        ///< W: sum of the photons' flux
  std::array<double, 3> emitted_flux{};       ///< W: what left the lights
  std::array<double, 3> escaped_flux{};       ///< W: left the scene
  std::array<double, 3> absorbed_flux{};      ///< W: absorbed at surfaces (and by roulette, in the mean)
};

/// Writes one .photons stream front to back; never seeks, so a pipe will do.
class PhotonWriter {
 public:
  /// `sink` is called with pieces of the file, in order; it throws if it cannot write.
  PhotonWriter(std::function<void(const void*, std::size_t)> sink, const PhotonHeader& header);
  ~PhotonWriter();
  /// Appends photons of one group as one or more blocks; an empty block of an overlay says "none now".
  void write(const PhotonBlock& block);
  /// A block already encoded by encode_block (so that checksums can be made in parallel).
  void write_encoded(std::string_view bytes, const PhotonBlock& block);
  /// Writes the end block; photon_count and stored_flux are filled in by the writer.
  void finish(const PhotonTotals& totals);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The bytes of a block, checksum included. Thread-safe.
std::string encode_block(const PhotonBlock& block, std::uint32_t columns);

/// Reads one .photons file front to back, one block in memory at a time; "-" is standard input.
/// Every truncation, flipped bit and value out of range is an InputError "FILE: byte OFFSET: REASON; REMEDY".
class PhotonReader {
 public:
  explicit PhotonReader(const std::string& path);
  ~PhotonReader();
  const PhotonHeader& header() const;
  /// Next block; false once the end block has been read and checked. An overlay's base (found beside it)
  /// is opened, its digest checked, and its untouched groups are delivered too: the caller sees one map.
  bool read_block(PhotonBlock& block);
  /// After the last block. Of an overlay: of the whole map.
  const PhotonTotals& totals() const;
  /// Hash of the data without header and history: equal content has equal digest, however it was cut into
  /// blocks, and an overlay with its base equals the map written whole. After the last block.
  std::string digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// All photons of a file in one array, file order; for readers that need the whole map.
struct PhotonMap {
  PhotonHeader header;
  PhotonTotals totals;
  std::vector<Photon> photons;
};
PhotonMap load_photons(const std::string& path);

}  // namespace tempolux::formats
