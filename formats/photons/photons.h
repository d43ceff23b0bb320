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
#include "formats/octahedral.h"

namespace tempolux::formats {

/// How light reached the photon, in Heckbert's notation (photons.md).
enum class PathKind : std::uint8_t { direct = 0, caustic = 1, indirect = 2, volume = 3, tentative = 4 };
inline constexpr std::size_t kPathKinds = 5;

/// One photon: a packet of flux that arrived at a point. 32 bytes, in memory as on disk.
struct Photon {
  std::array<float, 3> position{};  ///< m; world space minus the header's origin
  std::array<float, 3> flux{};  ///< W, linear Rec. 709; already divided by the number of emitted paths. Tentative: W m
  std::array<std::uint16_t, 2> normal{};  ///< octahedral: surface normal on the side the light arrived at
  std::uint16_t object = 0xffff;          ///< id.object; 0xffff in a medium or not known
  PathKind kind = PathKind::direct;
  std::uint8_t bounce = 0;  ///< scattering events since the light, saturating at 255

  bool operator==(const Photon&) const = default;
};
static_assert(sizeof(Photon) == 32);

/// Optional columns: present for every photon of the file or for none.
enum PhotonColumns : std::uint32_t {
  column_direction = 1,  ///< 4 bytes, octahedral wi: points back to where the light came from
  column_albedo = 2,     ///< 4 bytes: reflected share R, G, B in 1/255, then a zero byte
};

/// What the header says.
struct PhotonHeader {
  std::string history;                            ///< one line per tool, each ending in LF
  Identity identity;                              ///< which scene state this belongs to; may be empty
  std::array<double, 3> origin{};                 ///< m, world space
  std::uint32_t columns = 0;                      ///< PhotonColumns
  std::uint32_t group_count = 1;                  ///< N_g: photon i is of group i mod N_g
  std::uint64_t emitted_count = 0;                ///< paths started, over all groups
  std::string map = "global";                     ///< "global", "static" or "dynamic" (there flux may be < 0)
  std::string kinds = "direct,caustic,indirect";  ///< which kinds were stored
  std::string part;  ///< "low" or "high": holds that part of the light alone (photonmap-split); "": all of it
  /// Of an overlay: the file it changes, and that file's digest. Groups not in this file come from the base.
  std::string base_name, base_digest;
  std::string majorants;     ///< of tentative photons: hash of the majorants they were drawn from
  std::uint32_t pilots = 0;  ///< pilots of each group in the ledger; only with tentative photons
};

/// Photons of one group. Blocks of a group follow each other; groups never descend.
struct PhotonBlock {
  std::uint32_t group = 0;
  std::vector<Photon> photons;
  std::vector<std::array<std::uint16_t, 2>> directions;  ///< if column_direction
  std::vector<std::array<std::uint8_t, 4>> albedos;      ///< if column_albedo
};

/// What a pilot path met, to be compared when it is walked again in another frame. 32 bytes, in memory as on disk.
struct PhotonPilot {
  std::uint64_t extinctions = 0;  ///< hash of the extinctions that it looked at
  std::uint64_t collisions = 0;   ///< hash of the places where media scattered or absorbed it
  std::uint64_t vertices = 0;     ///< hash of its start and of the surfaces that it met, with distances
  double sketch = 0;  ///< W: sum over the places looked at of +-1 (drawn for the place) x flux x extinction / majorant

  bool operator==(const PhotonPilot&) const = default;
};
static_assert(sizeof(PhotonPilot) == 32);

/// What became of one group's flux [W]. All groups' entries make the ledger, from which the totals of an
/// overlay with its base follow exactly.
struct GroupFlux {
  std::uint32_t group = 0;
  std::array<double, 3> emitted{}, escaped{}, absorbed{};
  std::int32_t frame = 0;           ///< at which it was traced; only in files of version 1.3 with tentative photons
  std::uint64_t paths = 0;          ///< that it started; likewise
  std::vector<PhotonPilot> pilots;  ///< PhotonHeader::pilots of them, of its first paths

  bool operator==(const GroupFlux&) const = default;
};

/// Closing totals; summed over all groups of the file (of an overlay: over the groups it holds).
struct PhotonTotals {
  std::uint64_t photon_count = 0;
  std::array<double, 3> stored_flux{};    ///< W: exact sum of the photons' flux, rounded once
  std::array<double, 3> emitted_flux{};   ///< W: what left the lights
  std::array<double, 3> escaped_flux{};   ///< W: left the scene
  std::array<double, 3> absorbed_flux{};  ///< W: absorbed at surfaces (and by roulette, in the mean)

  bool operator==(const PhotonTotals&) const = default;
};

/// Writes one .photons stream front to back; never seeks, so a pipe will do. A mistake of the caller (groups
/// that descend, a photon out of the format's range, a kind the header does not name) is
/// std::invalid_argument: nothing that a reader would refuse is written.
class PhotonWriter {
 public:
  /// `sink` is called with pieces of the file, in order; it throws if it cannot write.
  PhotonWriter(std::function<void(const void*, std::size_t)> sink, const PhotonHeader& header);
  ~PhotonWriter();
  /// Appends photons of one group as one or more blocks; an empty block of an overlay says "none now", that
  /// of another file is left out.
  void write(const PhotonBlock& block);
  /// A block already encoded by encode_block(block, header.columns), so that checksums are made in parallel.
  /// Serial cost beside the sink: the exact sum and the range check, about 3 ns per photon.
  void write_encoded(std::string_view bytes, const PhotonBlock& block);
  /// Writes the end block; photon_count and stored_flux are filled in by the writer. With a `ledger` (every
  /// group ascending; of an overlay, which must have one: the groups it holds) emitted, escaped and absorbed
  /// flux are its sums and those of `totals` are not read. Returns the totals as written.
  PhotonTotals finish(const PhotonTotals& totals, std::span<const GroupFlux> ledger = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The bytes of a block, checksum included; more than 65536 photons become several blocks. Thread-safe.
std::string encode_block(const PhotonBlock& block, std::uint32_t columns);

struct PhotonReadOptions {
  bool digest = true;  ///< also hash the data: digest() may be called
};

/// Reads one .photons file front to back, one block in memory at a time; "-" is standard input.
/// Every truncation, flipped bit and value out of range is an InputError "FILE: byte OFFSET: REASON; REMEDY".
/// An unknown identity is no error: header().identity.known() is false, and the tool warns.
class PhotonReader {
 public:
  explicit PhotonReader(const std::string& path, const PhotonReadOptions& options = {});
  ~PhotonReader();
  /// Of an overlay: its own (identity, history and emitted_count of the whole map).
  const PhotonHeader& header() const;
  /// Next block that has photons; false once the end block has been read and checked. An overlay's base
  /// (found beside it) is opened, its digest checked at its end, and its untouched groups are delivered too:
  /// the caller sees one map.
  bool read_block(PhotonBlock& block);
  /// After the last block. Of an overlay: of the whole map.
  const PhotonTotals& totals() const;
  /// After the last block: group by group, empty if the file has none. Of an overlay: of the whole map.
  const std::vector<GroupFlux>& ledger() const;
  /// Hash of the data without header and history (photons.md, section 9): equal content has equal digest,
  /// however it was cut into blocks, and an overlay with its base equals the map written whole. After the
  /// last block.
  std::string digest() const;
  /// Most photons the file can hold by its size; 0 from a pipe. Of an overlay: with its base.
  std::uint64_t photon_count_bound() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// All photons of a file in one array, groups ascending; for readers that need the whole map. The column albedo is
/// checked and left out. Memory: 32 bytes per photon, 4 per direction, and one block.
struct PhotonMap {
  PhotonHeader header;
  PhotonTotals totals;
  std::vector<Photon> photons;
  std::vector<std::array<std::uint16_t, 2>> directions;  ///< of each photon, if the file has that column
};
PhotonMap load_photons(const std::string& path);
/// The same with those photons only that `keep` takes; all of the file is read and checked, and totals are of all.
PhotonMap load_photons(const std::string& path, const std::function<bool(const PhotonHeader&, const Photon&)>& keep);

}  // namespace tempolux::formats
