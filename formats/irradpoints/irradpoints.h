// formats/irradpoints/irradpoints.h -- read and write .irradpoints files, version 1.
//
// irradpoints.md is the definition of the format. If this code and that text disagree, the text is right.
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
#include "formats/octahedral.h"
#include "formats/surface_set.h"

namespace tempolux::formats {

/// Columns beside those of the kinds, as bits of IrradpointsHeader::columns.
enum IrradpointsColumns : std::uint32_t {
  column_points_noise = 1,  ///< IrradiancePointRecord::noise
};

/// Irradiance at one side of a surface point, by kind of the light that arrives.
struct IrradiancePointRecord {
  std::array<float, 3> position{};                    ///< m; world space minus the header's origin
  std::array<std::uint16_t, 2> normal{32767, 32767};  ///< octahedral: on the side that is lit (octahedral.h)
  std::uint16_t object = 0xffff;                      ///< id.object; 0xffff if not known
  SurfaceSet set = SurfaceSet::static_set;
  std::uint8_t reserved = 0;  ///< written as 0, read as 0
  float radius = 0;           ///< m: of the density estimate behind `indirect`; 0: there was none
  /// W/m^2, linear Rec. 709, >= 0; 0 of a kind that the header does not name.
  std::array<float, 3> direct{}, caustic{}, indirect{};
  /// W/m^2: number with a random sign whose mean square is the variance of caustic + indirect; 0 without its column
  std::array<float, 3> noise{};

  bool operator==(const IrradiancePointRecord&) const = default;
};
static_assert(sizeof(IrradiancePointRecord) == 72);

/// What the header says.
struct IrradpointsHeader {
  std::string history;             ///< one line per tool, each ending in LF
  Identity identity;               ///< scene state and frames for which the points are valid; may be empty
  std::array<double, 3> origin{};  ///< m, world space
  /// m, > 0: mean distance of points, sqrt(area / number of points): each stands for spacing^2 m^2.
  double spacing = 0;
  std::uint64_t emitted_count = 0;  ///< photon paths behind caustic and indirect; 0: none
  /// Kinds that were estimated, in this order; the others are not in the file.
  std::string kinds = "direct,caustic,indirect";
  std::uint32_t columns = 0;  ///< IrradpointsColumns
  std::string part;           ///< "low" or "high": holds that part of the light alone (photonmap-split); "": all of it
};

/// Closing totals: exact sums over the points of each kind's irradiance [W/m^2], rounded once. Times
/// spacing^2 they are the flux that arrives at the surfaces [W].
struct IrradpointsTotals {
  std::uint64_t point_count = 0;
  std::array<double, 3> direct{}, caustic{}, indirect{};

  bool operator==(const IrradpointsTotals&) const = default;
};

/// Writes one .irradpoints stream front to back; never seeks, so a pipe will do. A mistake of the caller (a
/// value out of the format's range, irradiance of a kind the header does not name) is std::invalid_argument:
/// nothing that a reader would refuse is written.
class IrradpointsWriter {
 public:
  /// `sink` is called with pieces of the file, in order; it throws if it cannot write.
  IrradpointsWriter(std::function<void(const void*, std::size_t)> sink, const IrradpointsHeader& header);
  ~IrradpointsWriter();
  /// Appends points, cut into blocks of at most 65536. The cut depends on the calls; the digest does not.
  void write(std::span<const IrradiancePointRecord> points);
  /// Writes the end block. Returns the totals as written.
  IrradpointsTotals finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A whole file.
struct IrradpointsFile {
  IrradpointsHeader header;
  IrradpointsTotals totals;
  std::vector<IrradiancePointRecord> records;
};

/// Reads and checks a file; "-" is standard input. Every truncation, flipped bit and value out of range is an
/// InputError "FILE: byte OFFSET: REASON; REMEDY". An unknown identity is no error: header.identity.known()
/// is false, and the tool warns. Memory: 72 bytes per point and one block.
IrradpointsFile load_irradpoints(const std::string& path);

/// Hash of the data without header and history (irradpoints.md, section 7): equal points in equal order have
/// equal digests, however they were cut into blocks.
std::string digest_of(const IrradpointsFile& file);

}  // namespace tempolux::formats
