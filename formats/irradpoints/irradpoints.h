// formats/irradpoints/irradpoints.h -- reads and writes .irradpoints files, version 1.
//
// irradpoints.md defines the format. If this code disagrees with that page, the page is right.
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

/// Irradiance on one side of a surface at a point, by kind of light.
struct IrradiancePointRecord {
  std::array<float, 3> position{};                    ///< m; world space minus the header's origin
  std::array<std::uint16_t, 2> normal{32767, 32767};  ///< octahedral (octahedral.h): normal of the lit side
  std::uint16_t object = 0xffff;                      ///< id.object; 0xffff if unknown
  SurfaceSet set = SurfaceSet::static_set;
  std::uint8_t reserved = 0;  ///< written as 0, read as 0
  float radius = 0;           ///< m: radius of the density estimate of `indirect`; 0: no estimate was made
  /// W/m^2, linear Rec. 709, >= 0. A kind that the header does not name is 0.
  std::array<float, 3> direct{}, caustic{}, indirect{};
  /// W/m^2: number with a random sign whose mean square is the variance of caustic + indirect; 0 without its column
  std::array<float, 3> noise{};

  bool operator==(const IrradiancePointRecord&) const = default;
};
static_assert(sizeof(IrradiancePointRecord) == 72);

/// The values of the header.
struct IrradpointsHeader {
  std::string history;             ///< one line per tool, each ending in LF
  Identity identity;               ///< scene state and frames for which the points are valid; may be empty
  std::array<double, 3> origin{};  ///< m, world space
  /// m, > 0: mean distance of points, sqrt(area / number of points). Each point represents an area of spacing^2.
  double spacing = 0;
  std::uint64_t emitted_count = 0;  ///< photon paths from which caustic and indirect were estimated; 0: none
  /// The estimated kinds, in this order; the file has no columns for the others.
  std::string kinds = "direct,caustic,indirect";
  std::uint32_t columns = 0;  ///< IrradpointsColumns
  std::string part;  ///< "low" or "high": the file holds only this part of the light (photonmap-split); "": all light
};

/// Totals in the end block: exact sums over the points of each kind's irradiance [W/m^2], rounded once. A sum times
/// spacing^2 is the flux [W] that arrives at the surfaces.
struct IrradpointsTotals {
  std::uint64_t point_count = 0;
  std::array<double, 3> direct{}, caustic{}, indirect{};

  bool operator==(const IrradpointsTotals&) const = default;
};

/// Writes one .irradpoints stream front to back, without seeking, so the output may be a pipe. Throws
/// std::invalid_argument for a value out of the format's range, or irradiance of a kind that the header does not
/// name. So every written file is one that readers accept.
class IrradpointsWriter {
 public:
  /// `sink` receives the pieces of the file, in order. It throws if it cannot write.
  IrradpointsWriter(std::function<void(const void*, std::size_t)> sink, const IrradpointsHeader& header);
  ~IrradpointsWriter();
  /// Appends points in blocks of at most 65536. The blocks depend on the calls; the digest does not.
  void write(std::span<const IrradiancePointRecord> points);
  /// Writes the end block and returns the totals.
  IrradpointsTotals finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The content of a file.
struct IrradpointsFile {
  IrradpointsHeader header;
  IrradpointsTotals totals;
  std::vector<IrradiancePointRecord> records;
};

/// Reads and checks a file; "-" is standard input. Throws InputError "FILE: byte OFFSET: REASON; REMEDY" for every
/// truncation, flipped bit and value out of range. An unknown identity is no error: header.identity.known() is then
/// false, and the tool warns. Memory: 72 bytes per point and one block.
IrradpointsFile load_irradpoints(const std::string& path);

/// Hash of the data without header and history (irradpoints.md, section 7). Equal points in equal order have equal
/// digests, whatever the blocks.
std::string digest_of(const IrradpointsFile& file);

}  // namespace tempolux::formats
