// formats/irradcache/irradcache.h -- reads and writes .irradcache files, version 1.
//
// irradcache.md defines the format. If this code disagrees with that page, the page is right.
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

/// Optional columns. A column is present for every record of the file, or for none.
enum IrradcacheColumns : std::uint32_t {
  column_influence = 1,  ///< IrradianceCacheRecord::influence
  column_update = 2,     ///< IrradianceCacheRecord::update
  column_clearance = 4,  ///< IrradianceCacheRecord::clearance_reach and clearance
  column_noise = 8,      ///< IrradianceCacheRecord::noise
};

/// Indirect irradiance gathered at one point, its gradients, and the radius within which the record is valid.
struct IrradianceCacheRecord {
  std::array<float, 3> position{};       ///< m; world space minus the header's origin
  std::array<float, 3> normal{0, 0, 1};  ///< shading normal on the lit side; length 1 within 1e-4
  std::uint16_t object = 0xffff;         ///< id.object of the object it moves with; 0xffff if unknown
  SurfaceSet set = SurfaceSet::static_set;
  std::uint8_t reserved = 0;          ///< written as 0, read as 0
  std::array<float, 3> irradiance{};  ///< W/m^2, linear Rec. 709, >= 0
  /// Gradients per channel. Rotational: E(n) = E + (n_i x n) . g [W/m^2]; translational: E(x) = E + (x - x_i) . g
  /// [W/m^3], with n_i and x_i the record's normal and position.
  std::array<std::array<float, 3>, 3> rotational{}, translational{};
  float radius = 1;  ///< m, > 0: the record is valid within this distance; clamped
  /// m, >= 0: before clamping and before neighbours reduce it; +inf: no gather ray hit a surface
  float radius_unclamped = 1;
  float influence = 0;            ///< W/m^2, >= 0: the largest change that movers can make; 0 without column_influence
  std::array<float, 3> update{};  ///< W/m^2: the movers' change at this frame, may be < 0; 0 without column_update
  /// m, > 0 or +inf: distance up to which clearance was measured; 0 without column_clearance
  float clearance_reach = 0;
  std::array<std::uint8_t, 16> clearance{};  ///< by spoke, in 1/255 of clearance_reach; 0 without
  /// W/m^2: number with a random sign whose mean square is the variance of irradiance; 0 without column_noise
  std::array<float, 3> noise{};

  bool operator==(const IrradianceCacheRecord&) const = default;
};
static_assert(sizeof(IrradianceCacheRecord) == 168);

/// IrradcacheHeader::least_cosine of files without this key.
inline constexpr double kLeastCosine = 0.94;

/// The values of the header.
struct IrradcacheHeader {
  std::string history;             ///< one line per tool, each ending in LF
  Identity identity;               ///< scene state and frames for which the records are valid; may be empty
  std::array<double, 3> origin{};  ///< m, world space
  std::uint32_t columns = 0;       ///< IrradcacheColumns
  // How the records were gathered; needed to add more records. 0: unknown.
  std::uint32_t rays = 0;  ///< gather rays per record
  double error_bound = 0;  ///< the accuracy from which the radii follow; the writing tool defines its meaning
  /// A record counts at a place with normal n if n . n_i is above this, in [0, 1). Records were placed for this
  /// value, and interpolation must use it.
  double least_cosine = kLeastCosine;
  /// m, > 0: the records leave out light of lamps that are closer than this to surfaces (irradcache.md, section 1); the
  /// reader samples it. 0: they hold all light.
  double lamps_apart = 0;
  double min_radius = 0, max_radius = 0;  ///< m: limits to which radii were clamped; max_radius 0: unknown
  /// Ranges {first, last} of the frames for whose cameras the records were placed; ascending, with gaps between them.
  /// Empty: unknown.
  std::vector<std::array<std::int32_t, 2>> placed_frames;
};

/// Totals in the end block.
struct IrradcacheTotals {
  std::uint64_t record_count = 0;
  std::array<double, 3> irradiance{};  ///< W/m^2: exact sum over all records, rounded once

  bool operator==(const IrradcacheTotals&) const = default;
};

/// Writes one .irradcache stream front to back, without seeking, so the output may be a pipe. Throws
/// std::invalid_argument for a value out of the format's range, or a value of a column that the header does not name.
/// So every written file is one that readers accept.
class IrradcacheWriter {
 public:
  /// `sink` receives the pieces of the file, in order. It throws if it cannot write.
  IrradcacheWriter(std::function<void(const void*, std::size_t)> sink, const IrradcacheHeader& header);
  ~IrradcacheWriter();
  /// Appends records in blocks of at most 65536. The blocks depend on the calls; the digest does not.
  void write(std::span<const IrradianceCacheRecord> records);
  /// Writes the end block and returns the totals.
  IrradcacheTotals finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The content of a file.
struct IrradcacheFile {
  IrradcacheHeader header;
  IrradcacheTotals totals;
  std::vector<IrradianceCacheRecord> records;
};

/// Reads and checks a file; "-" is standard input. Every truncation, flipped bit and value out of range is an
/// InputError "FILE: byte OFFSET: REASON; REMEDY". An unknown identity is no error: header.identity.known()
/// is false, and the tool warns. Memory: 168 bytes per record and one block.
IrradcacheFile load_irradcache(const std::string& path);

/// Hash of the data without header and history (irradcache.md, section 7). Equal records in equal order have equal
/// digests, whatever the blocks.
std::string digest_of(const IrradcacheFile& file);

}  // namespace tempolux::formats
