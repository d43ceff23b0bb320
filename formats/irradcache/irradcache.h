// formats/irradcache/irradcache.h -- read and write .irradcache files, version 1.
//
// irradcache.md is the definition of the format. If this code and that text disagree, the text is right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/error.h"
#include "formats/identity.h"
#include "formats/surface_set.h"

namespace tempolux::formats {

/// Optional columns: present for every record of the file or for none.
enum IrradcacheColumns : std::uint32_t {
  column_influence = 1,  ///< IrradianceCacheRecord::influence
  column_update = 2,     ///< IrradianceCacheRecord::update
  column_clearance = 4,  ///< IrradianceCacheRecord::clearance_reach and clearance
  column_noise = 8,      ///< IrradianceCacheRecord::noise
};

/// Indirect irradiance gathered at one point, how it changes around it, and how far that holds.
struct IrradianceCacheRecord {
  std::array<float, 3> position{};       ///< m; world space minus the header's origin
  std::array<float, 3> normal{0, 0, 1};  ///< shading normal on the lit side; length 1 within 1e-4
  std::uint16_t object = 0xffff;         ///< id.object it rides on; 0xffff if not known
  SurfaceSet set = SurfaceSet::static_set;
  std::uint8_t reserved = 0;          ///< written as 0, read as 0
  std::array<float, 3> irradiance{};  ///< W/m^2, linear Rec. 709, >= 0
  /// Per channel: E(n) = E + (n_i x n) . g [W/m^2] and E(x) = E + (x - x_i) . g [W/m^3]; n_i, x_i the
  /// record's.
  std::array<std::array<float, 3>, 3> rotational{}, translational{};
  float radius = 1;               ///< m, > 0: how far the record is valid, after clamping
  float radius_unclamped = 1;     ///< m, >= 0, before limits and neighbours; +inf: nothing was near
  float influence = 0;            ///< W/m^2, >= 0: change by what moves; 0 without column_influence
  std::array<float, 3> update{};  ///< W/m^2: E_t of this frame; may be < 0; 0 without column_update
  float clearance_reach = 0;      ///< m, > 0 or +inf: how far was looked around the record; 0 without column_clearance
  std::array<std::uint8_t, 16> clearance{};  ///< by spoke, in 1/255 of clearance_reach; 0 without
  /// W/m^2: number with a random sign whose mean square is the variance of irradiance; 0 without column_noise
  std::array<float, 3> noise{};

  bool operator==(const IrradianceCacheRecord&) const = default;
};
static_assert(sizeof(IrradianceCacheRecord) == 168);

/// IrradcacheHeader::least_cosine of files that do not say.
inline constexpr double kLeastCosine = 0.94;

/// What the header says.
struct IrradcacheHeader {
  std::string history;             ///< one line per tool, each ending in LF
  Identity identity;               ///< scene state and frames for which the records are valid; may be empty
  std::array<double, 3> origin{};  ///< m, world space
  std::uint32_t columns = 0;       ///< IrradcacheColumns
  // How it was gathered, for whoever extends it. 0: not known.
  std::uint32_t rays = 0;  ///< gather rays per record
  double error_bound = 0;  ///< accuracy that set the radii; its meaning is the maker's
  /// n . n_i above which a record counts, [0, 1): what it was placed for, and what to interpolate with.
  double least_cosine = kLeastCosine;
  double min_radius = 0, max_radius = 0;  ///< m: limits that radii were clamped to; max 0: not known
  /// Ranges {first, last} of the frames whose cameras it was placed for, ascending and apart; empty: not
  /// known.
  std::vector<std::array<std::int32_t, 2>> placed_frames;
};

/// Closing totals.
struct IrradcacheTotals {
  std::uint64_t record_count = 0;
  std::array<double, 3> irradiance{};  ///< W/m^2: exact sum over the records, rounded once

  bool operator==(const IrradcacheTotals&) const = default;
};

/// Writes one .irradcache stream front to back; never seeks, so a pipe will do. A mistake of the caller (a
/// value out of the format's range, a value of a column the header does not name) is std::invalid_argument:
/// nothing that a reader would refuse is written.
class IrradcacheWriter {
 public:
  /// `sink` is called with pieces of the file, in order; it throws if it cannot write.
  IrradcacheWriter(std::function<void(const void*, std::size_t)> sink, const IrradcacheHeader& header);
  ~IrradcacheWriter();
  /// Appends records, cut into blocks of at most 65536. The cut depends on the calls; the digest does not.
  void write(std::span<const IrradianceCacheRecord> records);
  /// Writes the end block. Returns the totals as written.
  IrradcacheTotals finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A whole file.
struct IrradcacheFile {
  IrradcacheHeader header;
  IrradcacheTotals totals;
  std::vector<IrradianceCacheRecord> records;
};

/// Reads and checks a file; "-" is standard input. Every truncation, flipped bit and value out of range is an
/// InputError "FILE: byte OFFSET: REASON; REMEDY". An unknown identity is no error: header.identity.known()
/// is false, and the tool warns. Memory: 168 bytes per record and one block.
IrradcacheFile load_irradcache(const std::string& path);

/// Hash of the data without header and history (irradcache.md, section 7): equal records in equal order have
/// equal digests, however they were cut into blocks.
std::string digest_of(const IrradcacheFile& file);

}  // namespace tempolux::formats
