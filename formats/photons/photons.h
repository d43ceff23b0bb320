// formats/photons/photons.h -- reads and writes .photons files, version 1.
//
// photons.md defines the format. If this code disagrees with that page, the page is right.
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

/// The kind of a photon, by its light path in Heckbert's notation (photons.md).
enum class PathKind : std::uint8_t { direct = 0, caustic = 1, indirect = 2, volume = 3, tentative = 4 };
inline constexpr std::size_t kPathKinds = 5;

/// One photon: a packet of flux that arrived at a point. 32 bytes, the same in memory and on disk.
struct Photon {
  std::array<float, 3> position{};  ///< m; world space minus the header's origin
  /// W, linear Rec. 709; already divided by the number of light paths. Tentative photons: W m
  std::array<float, 3> flux{};
  std::array<std::uint16_t, 2> normal{};  ///< octahedral: surface normal on the side at which the light arrived
  std::uint16_t object = 0xffff;          ///< id.object; 0xffff in a medium, or if unknown
  PathKind kind = PathKind::direct;
  std::uint8_t bounce = 0;  ///< scattering events since the light, saturating at 255

  bool operator==(const Photon&) const = default;
};
static_assert(sizeof(Photon) == 32);

/// Optional columns. A column is present for every photon of the file, or for none.
enum PhotonColumns : std::uint32_t {
  column_direction = 1,  ///< 4 bytes, octahedral wi: points back to where the light came from
  column_albedo = 2,     ///< 4 bytes: reflected share R, G, B in 1/255, then a zero byte
};

/// The values of the header.
struct PhotonHeader {
  std::string history;                            ///< one line per tool, each ending in LF
  Identity identity;                              ///< scene and state to which the map belongs; may be empty
  std::array<double, 3> origin{};                 ///< m, world space
  std::uint32_t columns = 0;                      ///< PhotonColumns
  std::uint32_t group_count = 1;                  ///< N_g: the number of groups; photon i is in group i mod N_g
  std::uint64_t emitted_count = 0;                ///< light paths started, over all groups
  std::string map = "global";                     ///< "global", "static" or "dynamic" (there flux may be < 0)
  std::string kinds = "direct,caustic,indirect";  ///< the stored kinds
  std::string part;  ///< "low" or "high": the file holds only this part of the light (photonmap-split); "": all light
  /// Only in an overlay: name and digest of its base. Groups that the overlay does not hold come from the base.
  std::string base_name, base_digest;
  std::string majorants;     ///< only with tentative photons: hash of the majorants with which they were drawn
  std::uint32_t pilots = 0;  ///< only with tentative photons: number of pilots of each group in the ledger
};

/// Photons of one group. Blocks of a group follow each other, and group numbers never decrease in a file.
struct PhotonBlock {
  std::uint32_t group = 0;
  std::vector<Photon> photons;
  std::vector<std::array<std::uint16_t, 2>> directions;  ///< if column_direction
  std::vector<std::array<std::uint8_t, 4>> albedos;      ///< if column_albedo
};

/// Hashes of what a pilot path met, for comparison when it is traced again in another frame. 32 bytes, the same in
/// memory and on disk.
struct PhotonPilot {
  std::uint64_t extinctions = 0;  ///< hash of the extinctions at its tentative collisions
  std::uint64_t collisions = 0;   ///< hash of the places where media scattered or absorbed it
  std::uint64_t vertices = 0;     ///< hash of its start and of its hits, with distances
  double sketch = 0;  ///< W: sum over the tentative collisions of s x flux x extinction / majorant; s is +1 or -1,
                      ///< drawn for the place

  bool operator==(const PhotonPilot&) const = default;
};
static_assert(sizeof(PhotonPilot) == 32);

/// The balance of one group's flux [W]. The ledger has an entry for every group; from the entries follow the exact
/// totals of an overlay together with its base.
struct GroupFlux {
  std::uint32_t group = 0;
  std::array<double, 3> emitted{}, escaped{}, absorbed{};
  std::int32_t frame = 0;   ///< at which the group was traced; only in files of version 1.3 with tentative photons
  std::uint64_t paths = 0;  ///< light paths that the group started; only in the same files
  std::vector<PhotonPilot> pilots;  ///< the group's first PhotonHeader::pilots paths

  bool operator==(const GroupFlux&) const = default;
};

/// Totals in the end block, over all groups of the file; in an overlay over the groups that it holds.
struct PhotonTotals {
  std::uint64_t photon_count = 0;
  std::array<double, 3> stored_flux{};   ///< W: exact sum of the photons' flux, rounded once
  std::array<double, 3> emitted_flux{};  ///< W: flux of the lights
  std::array<double, 3> escaped_flux{};  ///< W: flux that left the scene
  /// W: flux absorbed at surfaces; Russian roulette changes it, but not its mean
  std::array<double, 3> absorbed_flux{};

  bool operator==(const PhotonTotals&) const = default;
};

/// Writes one .photons stream front to back, without seeking, so the output may be a pipe. Throws
/// std::invalid_argument for groups that decrease, a photon out of the format's range, or a kind that the header does
/// not name. So every written file is one that readers accept.
class PhotonWriter {
 public:
  /// `sink` receives the pieces of the file, in order. It throws if it cannot write.
  PhotonWriter(std::function<void(const void*, std::size_t)> sink, const PhotonHeader& header);
  ~PhotonWriter();
  /// Appends photons of one group as one or more blocks. In an overlay an empty block is written: the group has no
  /// photons any more. In another file it is not.
  void write(const PhotonBlock& block);
  /// Appends a block that encode_block(block, header.columns) has encoded, so that callers can compute checksums in
  /// parallel. Serial cost besides the sink: exact sum and range check, about 3 ns per photon.
  void write_encoded(std::string_view bytes, const PhotonBlock& block);
  /// Writes the ledger and the end block, and returns the totals of the file. The writer itself has counted
  /// photon_count and stored_flux. Emitted, escaped and absorbed flux are the sums over the ledger; without a ledger
  /// they come from `totals`. The ledger has one entry per group, ascending: in an overlay per group of the overlay. An
  /// overlay or a file with tentative photons must have a ledger.
  PhotonTotals finish(const PhotonTotals& totals, std::span<const GroupFlux> ledger = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The bytes of a block with its checksum; more than 65536 photons become several blocks. Thread-safe.
std::string encode_block(const PhotonBlock& block, std::uint32_t columns);

struct PhotonReadOptions {
  bool digest = true;  ///< true to hash the data, so that digest() may be called
};

/// Reads one .photons file front to back, with one block in memory at a time; "-" is standard input. Throws
/// InputError "FILE: byte OFFSET: REASON; REMEDY" for every truncation, flipped bit and value out of range. An
/// unknown identity is no error: header().identity.known() is then false, and the tool warns.
class PhotonReader {
 public:
  explicit PhotonReader(const std::string& path, const PhotonReadOptions& options = {});
  ~PhotonReader();
  /// The header of the file. In an overlay, identity, history and emitted_count are those of the whole map.
  const PhotonHeader& header() const;
  /// Reads the next block that has photons; false after the end block was read and checked. If the file is an
  /// overlay, the reader opens the base in the same folder, also delivers the groups that only the base holds, and
  /// checks the base's digest at its end. So the caller sees one map.
  bool read_block(PhotonBlock& block);
  /// Totals of the whole map, also for an overlay. Valid after the last block.
  const PhotonTotals& totals() const;
  /// Ledger of the whole map, by group, also for an overlay; empty if the file has none. Valid after the last block.
  const std::vector<GroupFlux>& ledger() const;
  /// Hash of the data without header and history (photons.md, section 9). Equal content has an equal digest, whatever
  /// the blocks; an overlay with its base has the digest of the same map written whole. Valid after the last block.
  std::string digest() const;
  /// Upper bound of the number of photons, from the file's size, for an overlay including its base; 0 for a pipe.
  std::uint64_t photon_count_bound() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// All photons of a file in one array, by ascending group; for readers that need the whole map. The column albedo is
/// checked but not kept. Memory: 32 bytes per photon, 4 per direction, and one block.
struct PhotonMap {
  PhotonHeader header;
  PhotonTotals totals;
  std::vector<Photon> photons;
  std::vector<std::array<std::uint16_t, 2>> directions;  ///< by photon, if the file has the column
};
PhotonMap load_photons(const std::string& path);
/// The same, but keeps only photons for which `keep` returns true. The whole file is read and checked, and totals
/// cover all photons.
PhotonMap load_photons(const std::string& path, const std::function<bool(const PhotonHeader&, const Photon&)>& keep);

}  // namespace tempolux::formats
